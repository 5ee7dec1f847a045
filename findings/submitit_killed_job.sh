#!/bin/sh
# submitit's local executor calls a job FINISHED that was killed, as it does one that returned.
#
# A job is submitted, and its process is ended by SIGKILL before it returns, as an out-of-memory killer does. Its state,
# its being done, and waiting for it look the same as for a job that returned its result; only asking for the result
# raises. A program that counts what is FINISHED, or that looks at no results since its jobs write files, takes the
# killed job for a success. Seen with submitit 1.5.4 and Python 3.11:
#   returned: state FINISHED, done True, result 7
#   killed:   state FINISHED, done True, result raises UncompletedJobError
#
# Needs the network for PyPI, and Linux. Ends with status 1 if this changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q install submitit==1.5.4
cat >"$folder/submit.py" <<'PYTHON'
import os
import signal
import sys
import time

import submitit


def end_itself():
    os.kill(os.getpid(), signal.SIGKILL)


def outcome(job):
    job.wait()
    try:
        return job.state, job.done(), f"result {job.result()}"
    except submitit.core.utils.UncompletedJobError as error:
        return job.state, job.done(), f"result raises {type(error).__name__}"


def seven():
    time.sleep(1)
    return 7


executor = submitit.AutoExecutor(folder=sys.argv[1], cluster="local")
executor.update_parameters(timeout_min=1)
returned, killed = outcome(executor.submit(seven)), outcome(executor.submit(end_itself))
for name, (state, done, result) in (("returned:", returned), ("killed:  ", killed)):
    print(f"{name} state {state}, done {done}, {result}")
sys.exit(0 if returned[:2] == killed[:2] == ("FINISHED", True) and "raises" in killed[2] else 1)
PYTHON
"$folder/venv/bin/python" "$folder/submit.py" "$folder/logs"
