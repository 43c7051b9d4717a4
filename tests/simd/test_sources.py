"""Sources: where a func ends is what `inspect` says, for every func of ours; trees are lent and come back clean."""

import ast
import inspect
import linecache
import textwrap
from pathlib import Path
from types import CodeType, SimpleNamespace

import pytest

import render
import tiswarm
from tiswarm.simd import sources

pytestmark = pytest.mark.quick


def functions(code):
    """Give the codes of all functions that a code defines by `def`."""
    for each in code.co_consts:
        if isinstance(each, CodeType):
            if not each.co_name.startswith("<") and "__qualname__" not in each.co_names:
                yield each
            yield from functions(each)


@pytest.mark.parametrize(("package", "least"), [(tiswarm, 300), (render, 10)], ids=["tiswarm", "render"])
def test_a_func_of_taichi_s_ends_where_inspect_finds_that_it_does(package, least):
    reading = sources.lines_of(lambda func: asked.append(func.__code__) or inspect.getsourcelines(func.__code__))
    asked, seen = [], 0
    for path in Path(package.__file__).parent.rglob("*.py"):
        for code in functions(compile(path.read_text(encoding="utf-8"), str(path), "exec")):
            if "@ti." not in linecache.getline(str(path), code.co_firstlineno):
                continue
            lines, first = reading(SimpleNamespace(__code__=code))
            whole, begin = inspect.getsourcelines(code)
            trees = [ast.dump(ast.parse(textwrap.dedent("".join(text)))) for text in (lines, whole)]
            assert (trees[0], first) == (trees[1], begin), code
            seen += 1
    assert seen >= least
    assert not asked  # else little is gained


@pytest.mark.parametrize(
    "text",
    [
        'def func():\n    "Only a text."\n',
        "def func(a):\n    a += 1\n    'a text behind'\nother = 1\n",
        "@str\ndef func(a):\n    if a:\n        return 1\n    # a remark\n\n\nother = 1\n",
        "class A:\n    def func(self):\n        return [\n            1,\n            2,\n        ]\n\n    other = 1\n",
    ],
)
def test_what_has_no_instructions_is_read_too(text, tmp_path):
    path = tmp_path / "some.py"
    path.write_text(text, encoding="utf-8")
    (code,) = functions(compile(text, str(path), "exec"))
    lines, first = sources.lines_of(lambda func: inspect.getsourcelines(func.__code__))(SimpleNamespace(__code__=code))
    whole, begin = inspect.getsourcelines(code)
    assert first == begin
    assert ast.dump(ast.parse(textwrap.dedent("".join(lines)))) == ast.dump(ast.parse(textwrap.dedent("".join(whole))))


def test_a_module_that_was_changed_and_loaded_again_is_read_again(tmp_path):
    path, reading = tmp_path / "some.py", sources.lines_of(lambda func: None)
    for remark in ("", "# one\n# and two more lines\n"):
        text = f"{remark}def func(a):\n    return a\n"
        path.write_text(text, encoding="utf-8")
        (code,) = functions(compile(text, str(path), "exec"))
        assert "".join(reading(SimpleNamespace(__code__=code))[0]) == "def func(a):\n    return a\n"


def test_each_source_is_read_once():
    read = []
    reading = sources.once(lambda func: read.append(func) or ([], 1))

    def builder(number):
        def func():
            return number

        return func

    for number in range(3):
        assert reading(builder(number)) == ([], 1)
    assert len(read) == 1


def test_equal_code_of_two_files_is_read_twice():
    reading = sources.once(lambda func: func.__code__.co_filename)
    funcs = [{}, {}]
    for name, scope in zip(("a.py", "b.py"), funcs, strict=True):
        exec(compile("def func(): return 1", name, "exec"), scope)
    assert [reading(scope["func"]) for scope in funcs] == ["a.py", "b.py"]


def test_a_tree_is_lent_to_one_walk_at_a_time_and_comes_back_clean():
    trees, source = sources.Trees(), "def func(a):\n    return a.b(a)"
    one, other = trees.take(source), trees.take(source)
    assert one is not other
    as_parsed = ast.dump(one)
    one.body[0].args.args = []
    for node in ast.walk(one):
        node.ptr = node.caller = "found"
    trees.put(one)
    assert trees.take(source) is one
    assert ast.dump(one) == as_parsed
    assert not any(hasattr(node, "ptr") or hasattr(node, "caller") for node in ast.walk(one))
