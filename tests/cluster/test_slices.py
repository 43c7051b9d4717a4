"""Slices: every trial is in one of them, and none differs from what the whole batch gives."""

import numpy as np
import pytest

from tiswarm.cluster.slices import MOST_TRIALS, Gathered, cut
from tiswarm.cluster.worker import Task, difference, run
from tiswarm.engine.slices import run_spans
from tiswarm.studies.design import cells, load_study
from tiswarm.studies.run import grouped, run_study


def found(study):
    return grouped(cells(str(study), load_study(str(study)), seed=3))


@pytest.mark.quick
@pytest.mark.parametrize(("count", "workers"), [(1, 1), (20, 1), (20, 7), (1000, 3), (1000, 1000), (20, 0)])
def test_every_trial_is_in_exactly_one_slice(study, count, workers):
    seen = {cell.number: np.zeros(count, int) for group in found(study) for cell in group}
    for part in cut(found(study), count, workers):
        assert 0 < part.trials <= MOST_TRIALS
        for cell, (first, last) in zip(part.cells, part.spans, strict=True):
            seen[cell.number][first:last] += 1
    assert all((each == 1).all() for each in seen.values())


@pytest.mark.quick
def test_parts_of_a_cell_stand_in_the_order_of_its_trials_whenever_they_come(study):
    cell, gathered = found(study)[0][0], Gathered(6)
    parts = {span: ({"ticks": np.arange(*span)}, {"m": np.arange(*span) / 2}) for span in ((0, 2), (2, 5), (5, 6))}
    assert gathered.put(cell, (5, 6), parts[5, 6]) is None
    assert gathered.put(cell, (0, 2), parts[0, 2]) is None
    outcomes, measures = gathered.put(cell, (2, 5), parts[2, 5])
    np.testing.assert_array_equal(outcomes["ticks"], np.arange(6))
    np.testing.assert_array_equal(measures["m"], np.arange(6) / 2)


def test_slices_of_cells_give_the_bits_and_the_estimates_of_the_whole_study(study, f32):
    study.write_text(study.read_text().replace("figures = []", 'measures = ["success", "time", "polarisation"]'))
    whole, got = run_study(str(study), seed=3), {}
    gathered = Gathered(20)
    for own in [*cut(found(study), 20, 2)][::-1]:
        scenarios = [cell.scenario for cell in own.cells]
        parts = run_spans(scenarios, own.spans, 3, own.batch.company, own.batch.counts)
        for cell, span, part in zip(own.cells, own.spans, parts, strict=True):
            got[cell.number] = gathered.put(cell, span, part) or got.get(cell.number)
    for row in whole.rows:
        outcomes, measures = got[row.cell.number]
        for name, values in row.outcomes.items():
            if name in outcomes or name in measures:
                np.testing.assert_array_equal(values, (outcomes | measures)[name])


def test_trials_of_a_large_swarm_are_cut_to_the_same_bits(study, f32):
    text = study.read_text().replace("[2, 6]", "[6]").replace("[0.05, 0.1, 0.2]", "[0.05]").replace("trials = 20", "trials = 3")
    study.write_text(text.replace("= 60", '= 10, "world.neighbours" = "grid"'))
    row = run_study(str(study), seed=3).rows[0]
    slices = list(cut(found(study), 3, 1))
    assert [own.spans for own in slices] == [((0, 1),), ((1, 2),), ((2, 3),)]
    last = slices[2]
    ((outcomes, _),) = run_spans([row.cell.scenario], last.spans, 3, last.batch.company, last.batch.counts)
    for name, values in outcomes.items():
        np.testing.assert_array_equal(values, row.outcomes[name][2:])


@pytest.mark.quick
def test_a_worker_with_other_code_says_so_and_computes_nothing(study, monkeypatch):
    monkeypatch.setattr("tiswarm.cluster.worker._address", lambda: "tcp://there:1")
    task = Task((), (), (), (), (0, 0, 0), 3, "f32", 1, (), "tiswarm 0.0.1, taichi 1.0, code beef")
    with pytest.raises(ValueError, match=r"worker tcp://there:1 has other code .* than this client .*code beef.*; install"):
        run(task)
    assert "\n" not in difference("a", "b", "c")
