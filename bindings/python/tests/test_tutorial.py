"""docs/tutorials/python.md: its cells run one after the other, as printed."""
import pathlib
import re

import welkin

PAGE = pathlib.Path(__file__).resolve().parents[3] / "docs" / "tutorials" / "python.md"


def test_the_cells_of_the_tutorial_run(tmp_path, monkeypatch, image):
    monkeypatch.chdir(tmp_path)
    welkin.write("sample.hdr", image)
    cells = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
    assert len(cells) >= 5
    names = {}
    for cell in cells:
        # A sky of the page's size takes seconds; the call is the same.
        exec(compile(cell.replace("heights=16", "heights=8, orders=1"), str(PAGE), "exec"), names)
    assert (tmp_path / "specular.ktx2").exists()
