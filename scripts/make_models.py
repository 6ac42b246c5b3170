"""Makes the glTF models in assets/models from nothing but this script.

    blender -b --python-exit-code 1 -P scripts/make_models.py -- OUTDIR [MODEL...]

Needs Debian's blender (3.4), python3-numpy and python3-pil. The same versions give the same bytes.
"""

import sys
import tempfile
from importlib import import_module
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from models import export  # noqa: E402  (Blender does not put a script's folder on the path)

MODELS = ("robot", "plant", "vase", "poster", "block")


def main(arguments):
    if not arguments or not set(arguments[1:]) <= set(MODELS):
        sys.exit(f"usage: make_models.py -- OUTDIR [{'|'.join(MODELS)}...]")
    folder = Path(arguments[0]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for name in arguments[1:] or MODELS:
        export.start_scene()
        with tempfile.TemporaryDirectory() as scratch:
            animated = import_module(f"models.{name}").build(Path(scratch))
            export.write_glb(folder / f"{name}.glb", animated)


main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
