"""Themes: every colour and stroke of the picture, one frozen dataclass a theme."""

from dataclasses import dataclass, replace

from render.raster.shapes import Colour, colour, mixed


@dataclass(frozen=True)
class Theme:
    """Colours as "#rrggbb", opacities 0..1. Agents' colours follow Okabe and Ito: colour-blind viewers tell them apart."""

    backdrop: str  # the frame around the world
    world: str  # the world's floor
    glow: str  # light in the middle of the floor
    glow_alpha: float
    line: str  # edge of the world, grid, rules of the panel
    ink: str  # text that matters
    quiet: str  # text that accompanies
    prey: tuple[str, ...]  # the swarm, then its sub-swarms in turn
    predator: str
    sky: tuple[str, str]  # overhead and at the horizon, of a world without ground
    alarm: str  # mixed into alarmed prey
    target: str
    obstacle: str
    obstacle_light: str
    obstacle_edge: str  # outlines obstacles and walls, so that they stand off their ground
    shadow: str
    shadow_alpha: float
    arrived: str
    captured: str
    crashed: str
    danger: str  # tint of an area to fear
    safe: str  # tint of an area to rest in
    tint_alpha: float
    trail_alpha: float
    outline: str  # thin edge that lifts agents off their trails
    type_weight: float  # power of the ink's coverage: dark type looks thin in linear light and needs less than 1
    cleaned_alpha: float  # cleaned ground
    heat: tuple[str, str, str]  # density: sparse, middling, crowded
    ground_alpha: float = 1.0  # the world's floor, and the sky

    def __getitem__(self, name: str) -> Colour:
        """Give a colour of the theme as linear light."""
        return colour(getattr(self, name))

    @property
    def grounds(self) -> tuple[Colour, ...]:
        """Give what the world's floor and the sky look like, from edge to middle: marks must stand off all of them."""
        floor = self["world"]
        return floor, mixed(floor, self["glow"], self.glow_alpha), *(colour(each) for each in self.sky)

    def without_ground(self) -> "Theme":
        """Give the theme for pictures that are laid over others: no floor, no sky, no light on them and no shadow."""
        return replace(self, ground_alpha=0.0, glow_alpha=0.0, shadow_alpha=0.0)

    def label(self, hue: str) -> Colour:
        """Give the colour of words on an area of a hue: between it and the ink, for thin strokes need more contrast."""
        return mixed(self[hue], self["ink"], 0.45)


DARK = Theme(
    backdrop="#0a0e15",
    world="#101722",
    glow="#22344f",
    glow_alpha=0.5,
    line="#8fa3bf",
    ink="#edf1f7",
    quiet="#8f9db3",
    prey=("#5cc0f5", "#dd93c4", "#f2e66b", "#58d6b0"),
    predator="#ee5f1e",
    sky=("#0b1422", "#1d3550"),
    alarm="#ffffff",
    target="#27c498",
    obstacle="#3d4a60",
    obstacle_light="#6d7f9c",
    obstacle_edge="#7c8eab",
    shadow="#000000",
    shadow_alpha=0.55,
    arrived="#27c498",
    captured="#ee5f1e",
    crashed="#ffe45c",
    danger="#ee5f1e",
    safe="#27c498",
    tint_alpha=0.006,
    trail_alpha=0.55,
    outline="#0a0e15",
    type_weight=1.0,
    cleaned_alpha=0.1,
    heat=("#2b5797", "#3fa7d6", "#fff3b0"),
)

LIGHT = Theme(
    backdrop="#ece9e2",
    world="#f8f6f1",
    glow="#ffffff",
    glow_alpha=0.9,
    line="#5a6472",
    ink="#1b2430",
    quiet="#59626e",
    prey=("#0072b2", "#b0508c", "#8a7a00", "#00856a"),
    predator="#c24e00",
    sky=("#dfecf7", "#f6f3ea"),
    alarm="#00344f",
    target="#008662",
    obstacle="#a9adb5",
    obstacle_light="#d9dbdf",
    obstacle_edge="#787d86",
    shadow="#3a3226",
    shadow_alpha=0.28,
    arrived="#008662",
    captured="#c24e00",
    crashed="#3f3300",
    danger="#c24e00",
    safe="#008662",
    tint_alpha=0.06,
    trail_alpha=0.7,
    outline="#f8f6f1",
    type_weight=0.62,
    cleaned_alpha=0.3,
    heat=("#cfe3f2", "#3f8fc4", "#08306b"),
)

PRINT = Theme(
    backdrop="#ffffff",
    world="#ffffff",
    glow="#ffffff",
    glow_alpha=0.0,
    line="#000000",
    ink="#000000",
    quiet="#555555",
    prey=("#0072b2", "#b0508c", "#7a6c00", "#007a59"),
    predator="#c24e00",
    sky=("#ffffff", "#ffffff"),
    alarm="#00344f",
    target="#008662",
    obstacle="#c8c8c8",
    obstacle_light="#e4e4e4",
    obstacle_edge="#808080",
    shadow="#000000",
    shadow_alpha=0.0,
    arrived="#008662",
    captured="#c24e00",
    crashed="#3f3300",
    danger="#c24e00",
    safe="#008662",
    tint_alpha=0.05,
    trail_alpha=0.75,
    outline="#ffffff",
    type_weight=0.62,
    cleaned_alpha=0.3,
    heat=("#e0e0e0", "#808080", "#000000"),
)

THEMES = {"dark": DARK, "light": LIGHT, "print": PRINT}


def theme_named(theme: str | Theme) -> Theme:
    """Give a theme by name. Errors: ValueError."""
    if isinstance(theme, Theme):
        return theme
    if theme not in THEMES:
        raise ValueError(f"theme: unknown {theme!r}; use one of {', '.join(THEMES)}")
    return THEMES[theme]
