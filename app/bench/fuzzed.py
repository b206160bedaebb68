"""The OpenAPI description, fuzzed with schemathesis: is every answer as described, and none the server's own failure?

`python -m app.bench.fuzzed [EXAMPLES]`, with the packages of `pip install -e '.[bench]'`
"""

import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

from app.bench.served import ROBOT, Served, served

EXAMPLES = 300
"""For each operation."""
CHECKS = "not_a_server_error,status_code_conformance,content_type_conformance,response_schema_conformance,ignored_auth"
"""What a push must not be is said in words, so a body at random is refused: nothing says which would be taken."""
PHASES = "examples,coverage,fuzzing"
HOOKS = {"SCHEMATHESIS_HOOKS": "app.bench.zip_bodies"}
MISSING = "schemathesis is not installed: pip install -e '.[bench]'"


def fuzz(house: Served, examples: int) -> int:
    """Run it as a robot, its own report on the standard output; 0 when nothing was found."""
    program = Path(sys.executable).with_name("schemathesis")
    if not program.exists():
        raise SystemExit(MISSING)
    where = f"{house.interface}/openapi.json"
    options = ["--auth", f"{ROBOT}:{house.secret}", "--checks", CHECKS, "--phases", PHASES, "--seed", "0"]
    limits = ["--max-examples", str(examples), "--continue-on-failure", "--warnings", "off", "--no-color"]
    return subprocess.run([program, "run", where, *options, *limits], env=os.environ | HOOKS, check=False).returncode


def main(examples: int) -> int:
    """Fuzz, then see that the console still answers."""
    with served("paper") as house:
        code = fuzz(house, examples)
        house.console.wait_until_idle()
        refused: Counter[str] = house.door.guard.refused
    sys.stdout.write(f"the door has refused: {dict(refused)}\n")
    return code


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else EXAMPLES))
