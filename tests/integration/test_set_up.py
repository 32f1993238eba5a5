"""launch_scripts/setup.sh: the environment that it makes, whatever is in the way."""

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from tests.integration.test_scripts import ROOT, finished

NOBODY = 65534
# What the lock file of a checkout of its own names: one package of a few modules.
_EXIT = "import os, sys\nprint(*sys.argv[1:])\nsys.exit(int(os.environ.get({!r}, 0)))\n"
_MODULES = {f"{name}.py": _EXIT.format(name.upper()) for name in ("ruff", "mypy", "pytest")}
_MODULES |= {"foxglove.py": "", "websockets.py": ""}
_NODE = "import sys, foxglove, random\nprint('started', sys.flags.utf8_mode, random.random() < 1)\n"
# What notebooks, clouds, robots and clusters leave in the environment, and pip's file.
_HOSTILE = {
    "CDPATH": ".:/",
    "LD_PRELOAD": "/nowhere/libxalt_init.so",  # each program says on stderr that there is none
    "PYTHONWARNINGS": "error",
    "PYTHONHOME": "/nowhere",
    "PYTHONPLATLIBDIR": "nowhere",
    "PYTHONINSPECT": "1",
    "PIP_TARGET": "/proc/nowhere",
    "PIP_DRY_RUN": "1",
    "PIP_QUIET": "2",
    "GIT_DIR": "/nowhere",
}
_PIP_CONF = (
    "[global]\nonly-binary = :all:\n[install]\nprefix = /proc/nowhere\nconstraint = /nowhere\n"
)
# A Python that makes no environment.
_NO_VENV = f"""#!/bin/sh
case "$*" in "-I -m venv"*) exit 1 ;; *) exec {sys.executable} "$@" ;; esac
"""
# Builds an editable installation with what Python comes with.
_PROJECT = """[build-system]
requires = []
build-backend = "backend"
backend-path = ["."]
"""
_BACKEND = """
import zipfile

def build_editable(folder, *_):
    about = "project-1.dist-info"
    files = {
        "project.pth": "".join(f"../../../../src/{name}\\n" for name in PACKAGES),
        f"{about}/METADATA": "Metadata-Version: 2.1\\nName: project\\nVersion: 1\\n",
        f"{about}/WHEEL": "Wheel-Version: 1.0\\nRoot-Is-Purelib: true\\nTag: py3-none-any\\n",
    }
    files[f"{about}/RECORD"] = "".join(f"{name},,\\n" for name in files)
    with zipfile.ZipFile(f"{folder}/project-1-py3-none-any.whl", "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return "project-1-py3-none-any.whl"

PACKAGES = "eye_plant sparse_coder vergence_rl experiment_manager active_binocular_vision".split()
"""


class Checkout:
    """The scripts in a folder of their own, whose lock file names a wheel beside it."""

    def __init__(self, folder: Path) -> None:
        self.root = folder / "Prüf stand"
        self.hostile = folder / "notebook"
        self.hostile.mkdir()
        (self.hostile / "random.py").touch()
        (self.hostile / "pip.conf").write_text(_PIP_CONF)
        environment = "src/lockstep/lockstep/machine/environment.py"
        shutil.copytree(ROOT / "launch_scripts", self.root / "launch_scripts")
        (self.root / environment).parent.mkdir(parents=True)
        shutil.copy(ROOT / environment, self.root / environment)
        for module in ("eye_plant.plant", "sparse_coder.node", "vergence_rl.node"):
            self.write_module(module, "")
        self.write_module("active_binocular_vision.__main__", _NODE)
        (self.root / "pyproject.toml").write_text(_PROJECT)
        (self.root / "backend.py").write_text(_BACKEND)
        wheel = folder / "small-1.0-py3-none-any.whl"
        about = "small-1.0.dist-info"
        files = _MODULES | {
            f"{about}/METADATA": "Metadata-Version: 2.1\nName: small\nVersion: 1.0\n",
            f"{about}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        }
        files[f"{about}/RECORD"] = "".join(f"{name},,\n" for name in files)
        with zipfile.ZipFile(wheel, "w") as archive:
            for name, text in files.items():
                archive.writestr(name, text)
        self.lock = self.root / "requirements.lock"
        sha256 = hashlib.sha256(wheel.read_bytes()).hexdigest()
        self.lock.write_text(f"small @ {wheel.as_uri()} --hash=sha256:{sha256}\n")

    def write_module(self, name: str, text: str) -> None:
        package, module = name.split(".")
        file = self.root / "src" / package / package / f"{module}.py"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)

    def start_among(self, name: str, *words: str, **options: Any) -> Any:
        """Start a script from the folder and in the environment of a hostile user."""
        script = Path(os.path.relpath(self.root / "launch_scripts" / f"{name}.sh", self.hostile))
        hostile = _HOSTILE | {"PIP_CONFIG_FILE": str(self.hostile / "pip.conf")} | options
        return finished(script, *words, cwd=self.hostile, **hostile)

    def start(self, name: str, *words: str, **options: Any) -> subprocess.CompletedProcess[str]:
        script = self.root / "launch_scripts" / f"{name}.sh"
        return finished(script, *words, cwd=Path("/"), **{"LC_ALL": "C", **options})


@pytest.fixture(scope="module")
def ready(tmp_path_factory: pytest.TempPathFactory) -> Checkout:
    """Return a checkout whose first set-up failed, and which two then set up at the same time."""
    checkout = Checkout(tmp_path_factory.mktemp("ready"))
    right = checkout.lock.read_text()
    checkout.lock.write_text(re.sub("sha256:.", "sha256:x", right))
    broken = checkout.start("eye_plant", code=1)
    assert broken.stdout == ""
    assert broken.stderr.splitlines()[-1].startswith("setup: pip could not install")
    checkout.lock.write_text(right)
    checkout.write_module("experiment_manager.node", "import nowhere\n")
    lacking = checkout.start("setup", code=1).stderr.splitlines()[-1]
    assert lacking.endswith("be imported: ModuleNotFoundError: No module named 'nowhere'")
    checkout.write_module("experiment_manager.node", "import foxglove\n")
    with ThreadPoolExecutor(2) as pool:
        said = [done.stderr for done in pool.map(checkout.start_among, ["setup"] * 2)]
    assert sorted(text.count("setup: installing 1 Python packages") for text in said) == [0, 1]
    return checkout


def test_what_is_set_up_starts_without_a_word(ready: Checkout) -> None:
    # The path has an umlaut, the locale is C, and the package is found nevertheless.
    started = ready.start("eye_plant")
    assert (started.stdout, started.stderr) == ("started 1 True\n", "")


def test_nothing_in_the_environment_and_the_folder_of_a_user_is_in_the_way(ready: Checkout) -> None:
    started = ready.start_among("eye_plant")
    assert started.stdout == "started 1 True\n"
    assert "setup: " not in started.stderr  # not made again because somebody writes to stderr


@pytest.mark.parametrize(
    ("environment", "status"),
    [
        ({}, 0),
        ({"RUFF": "1"}, 1),
        ({"MYPY": "2"}, 1),
        ({"PYTEST": "2"}, 2),
        ({"PYTEST": "2", "RUFF": "1"}, 2),
    ],
)
def test_every_check_counts_and_pytest_has_the_last_word(ready, environment, status) -> None:
    tested = ready.start("test", "-n", "0", "-x", code=status, **environment)
    call = tested.stdout.splitlines()[-1]
    # Of two options of a name the last one holds.
    assert call.startswith(f"-n {len(os.sched_getaffinity(0)) + 1} ")
    assert call.endswith(" -n 0 -x")


def test_another_lock_file_asks_for_a_set_up_which_asks_for_a_python(ready: Checkout) -> None:
    text = ready.lock.read_text()
    ready.lock.write_text(f"# changed\n{text}")
    begun = ready.start("eye_plant", code=1, ABV_PYTHON="/bin/false")
    sentence = "setup: ABV_PYTHON=/bin/false is not a Python 3.11 to 3.14 with its venv module."
    assert begun.stderr.splitlines() == [sentence]


@pytest.mark.skipif(os.getuid() != 0, reason="needs root, to be two users")
@pytest.mark.parametrize("words", [[], ["--again"]])
def test_an_environment_of_another_user_is_named_as_such(words: list[str]) -> None:
    with tempfile.TemporaryDirectory() as shared:
        Path(shared).chmod(0o755)
        checkout = Checkout(Path(shared))
        (checkout.root / ".venv").mkdir()
        (line,) = checkout.start("setup", *words, user=NOBODY, code=1).stderr.splitlines()
    assert line.startswith(f"setup: {checkout.root}/.venv belongs to the user root, and ")
    assert f"git clone {checkout.root}" in line


@pytest.mark.parametrize("kind", ["link", "dangling link", "folder"])
def test_an_environment_that_set_up_did_not_make_is_set_aside(tmp_path: Path, kind: str) -> None:
    checkout, other = Checkout(tmp_path), tmp_path / "theirs"
    no_venv = tmp_path / "python"
    no_venv.write_text(_NO_VENV)
    no_venv.chmod(0o755)
    venv = checkout.root / ".venv"
    if kind != "dangling link":
        (other / "bin").mkdir(parents=True)
        (other / "bin" / "python").write_text("theirs")
    if kind == "link":
        (other / "set_up").write_text("theirs")
    if kind == "folder":
        other.rename(venv)
    else:
        venv.symlink_to(other)
    before = _content(venv)
    said = checkout.start("setup", "--again", ABV_PYTHON=str(no_venv), code=1).stderr
    (aside,) = checkout.root.glob(".venv.*")
    assert f".venv was not made by this script: it is now {aside}\n" in said
    assert aside.is_symlink() == (kind != "folder")
    assert _content(aside) == before
    # What it made itself, and did not finish, it clears.
    (venv / "half").mkdir()
    checkout.start("setup", ABV_PYTHON=str(no_venv), code=1)
    assert not (venv / "half").exists()
    assert list(checkout.root.glob(".venv.*")) == [aside]


def _content(folder: Path) -> dict[str, str]:
    return {str(f.relative_to(folder)): f.read_text() for f in folder.glob("**/*") if f.is_file()}


@pytest.mark.skipif(os.getuid() != 0, reason="only root installs packages")
@pytest.mark.parametrize(
    ("would", "said", "calls"),
    [
        ("Inst python3-venv (3.11)", "apt-get could not install", ["update", "--simulate", "-y"]),
        ("Inst mesa [1] (2)", "apt-get would change other packages", ["update", "--simulate"]),
        ("Remv editor [1]", "apt-get would change other packages", ["update", "--simulate"]),
    ],
)
def test_no_package_of_the_system_is_changed(tmp_path: Path, would, said, calls) -> None:
    checkout, programs, log = Checkout(tmp_path), tmp_path / "bin", tmp_path / "log"
    programs.mkdir()
    apt = f"""#!/bin/sh
case "$*" in *--simulate*) echo "{would}" ;; esac
echo "$*" >>{log}
case "$*" in *" -y "*) exit 100 ;; esac
"""
    for name in ("python3", *(f"python3.{minor}" for minor in range(11, 15)), "apt-get"):
        (programs / name).write_text(apt if name == "apt-get" else "#!/bin/sh\nexit 1\n")
        (programs / name).chmod(0o755)
    path = f"{programs}:{os.environ['PATH']}"
    failed = checkout.start("setup", ABV_PYTHON="", PATH=path, code=1).stderr
    assert failed.splitlines()[-1].startswith(f"setup: {said} ")
    made = [line.split() for line in log.read_text().splitlines()]
    assert [next(word for word in calls if word in words) for words in made] == calls


@pytest.mark.skipif(os.getuid() != 0, reason="needs root, to mount a folder")
def test_a_folder_without_programs_is_named_at_once(tmp_path: Path) -> None:
    mount = "mount -t tmpfs -o noexec tmpfs .venv && exec launch_scripts/setup.sh"
    root = Checkout(tmp_path).root
    (root / ".venv").mkdir()
    said = finished("unshare", "--mount", "sh", "-c", mount, cwd=root, code=1).stderr
    assert said.splitlines()[-1].endswith("is mounted with noexec.")


def test_changed_sources_have_a_numba_cache_of_their_own(tmp_path: Path) -> None:
    checkout = Checkout(tmp_path)
    source = checkout.root / "src" / "coder.py"
    script = 'source launch_scripts/environment.sh; export_variables "$0"; echo $NUMBA_CACHE_DIR'
    named = []
    for text in ("import numba", "import numba  # changed", "import numba"):
        source.write_text(text)
        named.append(
            finished("bash", "-euc", script, sys.executable, cwd=checkout.root).stdout.strip()
        )
    assert named[0] == named[2] != named[1]
    assert all(name.startswith(f"{checkout.root}/.venv/numba_cache/") for name in named)
