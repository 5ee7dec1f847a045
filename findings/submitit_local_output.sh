#!/bin/sh
# submitit's local executor lets its jobs' controllers inherit the output of the program that submits.
#
# A job's own output goes to files in the folder of its logs. Its controller, a process that outlives the submitting
# program, keeps that program's standard output open all the same. A reader of that output, such as a pipe or
# subprocess.run(capture_output=True), therefore meets its end only when the last job ends, though the program that it
# reads from ended long before. Seen with submitit 1.5.4 and Python 3.11: the controller's descriptors 1 and 2 are those
# of the submitting program:
#   output of the submitting program: pipe:[4711]
#   output of the job's controller:   pipe:[4711]
#
# Needs the network for PyPI, and Linux. Ends with status 1 if this changes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" -q install submitit==1.5.4
cat >"$folder/submit.py" <<'PYTHON'
import os
import sys
import time

import submitit

executor = submitit.AutoExecutor(folder=sys.argv[1], cluster="local")
executor.update_parameters(timeout_min=1)
job = executor.submit(time.sleep, 5)
mine, its = (os.readlink(f"/proc/{number}/fd/1") for number in (os.getpid(), job.job_id))
print("output of the submitting program:", mine)
print("output of the job's controller:  ", its)
job.wait()
sys.exit(0 if mine == its and mine.startswith("pipe:") else 1)
PYTHON
said=$("$folder/venv/bin/python" "$folder/submit.py" "$folder/logs") && status=0 || status=$?
printf '%s\n' "$said"
exit "$status"
