import pytest

from rotrecon.tool_table import ToolTableError, read_tools

CUTTER = '[cutter]\nname = "cutter"\ntakes = ["cylinder"]\ndiameter_mm = [20, 100]\n'


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "holds no tool"),
        ("[cutter", "is not TOML"),
        ('cutter = "sharp"', r"\[cutter\]"),
        ('[cutter]\nname = "x"\n', "missing required field"),
        (CUTTER + "colour = 3\n", "unknown field `colour`"),
        (CUTTER + "opening_mm = 50\n", "widen the opening"),
        (CUTTER.replace("[20, 100]", "[100, 20]"), "is not a range"),
        (CUTTER.replace("[20, 100]", "[-1, 20]"), "diameter_mm"),
        (CUTTER.replace("[20, 100]", "[20, inf]"), "is not a range"),
        (CUTTER.replace('["cylinder"]', "[]"), "at least one"),
        (CUTTER.replace('["cylinder"]', '["cylinder", "cylinder"]'), "each once"),
        (CUTTER.replace('"cutter"', '" "'), "has no name"),
        (CUTTER + "min_length_over_diameter = inf\n", "not finite"),
        (CUTTER.replace('["cylinder"]', '["brick"]'), "brick"),
        (CUTTER + CUTTER.replace("[cutter]", "[other]"), "two tools have the name"),
    ],
)
def test_tables_that_contradict_themselves(tmp_path, text, says):
    file = tmp_path / "tools.toml"
    file.write_text(text)
    with pytest.raises(ToolTableError, match=says) as caught:
        read_tools(file)
    assert str(file) in str(caught.value)


def test_missing_table(tmp_path):
    with pytest.raises(ToolTableError, match="cannot be read"):
        read_tools(tmp_path / "none.toml")
