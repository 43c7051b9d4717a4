"""The table of a live page, without processes: nothing that was said of other numbers is told of those of now."""

from types import SimpleNamespace

import pytest

import tiswarm
from render.live.table import Table

pytestmark = pytest.mark.quick


@pytest.fixture
def table():
    """A table that asks at once; `asked` and `told` are what it asked and told."""
    asked, told = [], []
    loop = SimpleNamespace(call_later=lambda _, act, *words: act(*words) or SimpleNamespace(cancel=lambda: None))
    made = Table(SimpleNamespace(send=lambda _, question: asked.append(question)), loop, lambda _, words: told.append(words))
    return SimpleNamespace(table=made, asked=asked, told=told)


def answer(table, question, mean):
    table.table.estimated("trials", (question.number, 1000, {"success": (mean, mean, mean)}, 0.1))


def test_an_answer_to_an_earlier_question_is_not_told(table):
    scenario = tiswarm.load("delft/pronav-10")
    table.table.settle(scenario, 0, 1)
    answer(table, table.asked[0], 0.5)
    table.table.settle(scenario.replaced({"prey.goal": 0.3}), 0, 2)
    assert (table.told[-1]["serial"], table.told[-1]["now"]) == (2, {})
    assert table.told[-1]["before"]["rows"]["success"][0] == 0.5
    count = len(table.told)
    answer(table, table.asked[0], 0.6)
    table.table.estimated("untried", (table.asked[0].number, "no"))
    assert len(table.told) == count
    answer(table, table.asked[1], 0.7)
    assert table.told[-1]["now"]["rows"]["success"][0] == 0.7


def test_the_same_trials_once_more_are_not_asked_again(table):
    scenario = tiswarm.load("delft/pronav-10")
    table.table.settle(scenario, 0, 1)
    answer(table, table.asked[0], 0.5)
    table.table.count([3, 3, 0, 0], 60.0)
    table.table.settle(scenario, 0, 2)
    assert len(table.asked) == 1
    assert table.told[-1] == table.told[-2] | {"serial": 2, "watched": {"trials": 0, "rows": {}}}
    table.table.settle(scenario, 1, 3)
    assert len(table.asked) == 2
