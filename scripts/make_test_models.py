"""Makes the small glTF files of the golden pictures, test/golden/models, from nothing.

    python3 scripts/make_test_models.py [OUTDIR]

Needs nothing but Python 3.9; gives the same bytes wherever zlib does.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent
sys.path.insert(0, str(ROOT))

from models import test_models  # noqa: E402  (a script's folder is not always on the path)


def main(arguments):
    folder = Path(arguments[0]) if arguments else ROOT.parent / "test" / "golden" / "models"
    folder.mkdir(parents=True, exist_ok=True)
    for name in test_models.MODELS:
        test_models.build(name).write(folder / f"{name}.gltf")


main(sys.argv[1:])
