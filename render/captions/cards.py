"""Cards: before a film what it shows and what its marks mean, after it how that ended."""

import numpy as np

from render.captions.caption import Caption, Counter, fated, fitting, introduced
from render.captions.layout import dealt
from render.raster.glyphs import Atlas, width, wrapped
from render.raster.shapes import ALPHA, NONE, boxes, moved
from render.scene.scene import Scene
from render.scene.signs import PARTED
from render.scene.trajectories import ALIVE, ARRIVED

FADE = 0.25
"""How long a card comes or goes [s of film]."""

VEIL = 0.96
"""Opacity of the card, through which its film is seen."""

TITLES, NOTE, WHO, KEY, HEAD, NUMBER = (54, 46, 40, 34, 28, 24), 19, 24, 20, 30, 54
"""Sizes of words."""

SHARE = 0.84
"""Words are at most this share of the frame wide."""


class Cards(Caption):
    """The cards of a film."""

    def __init__(self, scene: Scene, size: tuple[int, int], unit: float, atlas: Atlas, found: list[Counter], note: str):
        """Take what to tell. found, note: what `counters` and `notes` tell of one subject; none are counted together."""
        super().__init__(scene, atlas, unit)
        self._size, self._found, self._note = size, found, note
        self._made: dict[str, np.ndarray] = {}
        self._within(0, 0)

    def frame(self, name: str, age: float, left: float) -> np.ndarray:
        """Draw a card. name: "opening" or "closing". age, left: since it came and until it goes [s of film]."""
        if name not in self._made:
            self._made[name] = self._opening() if name == "opening" else self._closing()
        rows = self._made[name].copy()
        shown = min(left if name == "opening" else age, FADE) / FADE  # a film begins, and ends, with a card at its fullest
        rows[:, ALPHA : ALPHA + 2] *= max(shown, 0.0)
        return rows

    def _opening(self) -> np.ndarray:
        unit, room = self._unit, SHARE * self._size[0]
        scenario = self._scene.subjects[0].scenario
        title, size = fitting(self._words.title(scenario), TITLES, room, 3, unit)
        lines: list[tuple[float, np.ndarray]] = [(1.16 * size, self._centred(line, size, "ink")) for line in title]
        lines.append((14, NONE))
        for line in wrapped(self._note, self._px(NOTE), int(room), 3):
            lines.append((1.4 * NOTE, self._centred(line, NOTE, "quiet")))
        lines.append((26, NONE))
        if len(self._scene.subjects) == 1:
            lines += [(1.6 * WHO, self._player(*who)) for who in introduced(self._scene)]
            lines.append((18, NONE))
        lines += [(1.6 * KEY, row) for row in self._explained()]
        return self._stacked(lines)

    def _closing(self) -> np.ndarray:
        scenario, paths = self._scene.subjects[0].scenario, self._scene.paths
        paths.reach(paths.last)  # from there all ends are known
        time = paths.last * scenario.world.dt
        who = self._words.counted(scenario, "prey", paths.prey)
        words = self._words.say("lines.after", who=who, time=self._words.whole(round(time)))
        counts = [(each.text(paths.last), each.unit, each.name, each.sign) for each in self._found]
        counts = counts or self._totals()
        left = iter(counts)
        rooms = dealt([self._room(each, NUMBER) for each in counts], SHARE * self._size[0], 0.0)
        rows = [[next(left) for _ in row] for row in rooms]
        lines = [(44.0, self._centred(words, HEAD, "ink")), (24.0, NONE)]
        return self._stacked(lines + [(1.3 * NUMBER, self._counts(row, NUMBER)) for row in rows])

    def _totals(self) -> list[tuple[str, str, str, int | None]]:
        """Count what became of the prey of all subjects."""
        paths = self._scene.paths
        fates = np.where(paths.end <= paths.last, paths.fate, ALIVE)[paths.is_prey]
        shown = [fate for fate in self._key if fate != PARTED] or [ALIVE]
        return [(self._words.whole(int((fates == fate).sum())), "", fated(self._scene, fate), fate) for fate in shown]

    def _room(self, each: tuple[str, str, str, int | None], size: float) -> float:
        text, measure, name, sign = each
        small = self._px(0.45 * size)
        words = width(f"{measure} {name}".strip(), small)
        return width(text, self._px(size), tabular=True) + words + (0.9 if sign is None else 1.4) * size * self._unit

    def _counts(self, counts: list[tuple[str, str, str, int | None]], size: float) -> np.ndarray:
        """Write numbers, each before its sign and name, in a row about the middle."""
        x, unit, rows = -sum(self._room(each, size) for each in counts) / 2, self._unit, [NONE]
        for each in counts:
            text, measure, name, sign = each
            rows.append(self._write(text, x, 0, size, "ink", tabular=True))
            spot = x + width(text, self._px(size), tabular=True) + 0.25 * size * unit
            if sign is not None:
                rows.append(self._sign(sign, spot + 0.2 * size * unit, -0.16 * size * unit, 0.17 * size * unit))
                spot += 0.5 * size * unit
            rows.append(self._write(f"{measure} {name}".strip(), spot, 0, 0.45 * size, "quiet"))
            x += self._room(each, size)
        return np.concatenate(rows)

    def _centred(self, text: str, size: float, paint: str) -> np.ndarray:
        return self._write(text, 0, 0, size, paint, "centre")

    def _player(self, kind: str, who: str, how: str) -> np.ndarray:
        unit = self._unit
        wide = 34 * unit + width(who, self._px(WHO)) + (12 * unit + width(how, self._px(NOTE)) if how else 0)
        x = -wide / 2
        rows = [self._likeness(kind, x + 11 * unit, -8 * unit, 1.2 * unit), self._write(who, x + 34 * unit, 0, WHO, "ink")]
        if how:
            rows.append(self._write(how, x + wide - width(how, self._px(NOTE)), 0, NOTE, "quiet"))
        return np.concatenate(rows)

    def _explained(self) -> list[np.ndarray]:
        """Explain the signs of what can become of prey, and the colours of a swarm's parts, in as many rows as they need."""
        unit, reached = self._unit, {ARRIVED: self._words.say("fates.reached")}
        named = [(fate, reached.get(fate) or fated(self._scene, fate)) for fate in self._key]
        rows, gap, left = [], 26 * unit, iter(named)
        for row in dealt([width(word, self._px(KEY)) + 24 * unit for _, word in named], SHARE * self._size[0], gap):
            x, shapes = -(sum(row) + (len(row) - 1) * gap) / 2, []
            for wide in row:
                fate, word = next(left)
                shapes.append(self._sign(fate, x + 8 * unit, -7 * unit, 7 * unit))
                shapes.append(self._write(word, x + 24 * unit, 0, KEY, "quiet"))
                x += wide + gap
            rows.append(np.concatenate(shapes))
        return rows

    def _stacked(self, lines: list[tuple[float, np.ndarray]]) -> np.ndarray:
        """Put lines, drawn about (0, 0), one below the other in the middle of a veil. Each has its height [units of type]."""
        high = sum(each for each, _ in lines) * self._unit
        y, middle = (self._size[1] - high) / 2, self._size[0] / 2
        rows = [boxes((0.0, 0.0), self._size, self._theme["backdrop"], VEIL)]
        for tall, shapes in lines:
            y += tall * self._unit
            rows.append(moved(shapes, (round(middle), round(y))))
        return np.concatenate(rows)
