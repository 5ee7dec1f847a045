"""The files that come with the package are found installed and in the repository."""

import pytest

from mfr_bench import resources
from mfr_bench.errors import MfrError


def test_the_repository_has_them():
    assert (resources.configs_dir() / "smoke.yaml").is_file()
    assert resources.shaders_dir().is_dir()


def test_an_installed_package_uses_its_own(tmp_path, monkeypatch):
    monkeypatch.setattr(resources, "PACKAGE", tmp_path / "mfr_bench")
    inside = tmp_path / "mfr_bench" / "_data" / "configs"
    beside = tmp_path / "configs"
    beside.mkdir()
    assert resources.configs_dir() == beside
    inside.mkdir(parents=True)
    assert resources.configs_dir() == inside


def test_a_broken_installation_says_where_it_looked(tmp_path, monkeypatch):
    monkeypatch.setattr(resources, "PACKAGE", tmp_path / "mfr_bench")
    with pytest.raises(MfrError, match=r"the shaders of mfr-bench are missing: neither .*_data/shaders nor .*/shaders"):
        resources.shaders_dir()
