#!/bin/sh
# Measures on a GPU, within a given time and in one call, what software drivers cannot show; a later call goes on.
#
#   scripts/gpu-session.sh [TIME] [DIR]     e.g. scripts/gpu-session.sh 8m gpu-results
#   scripts/gpu-session.sh forecast [DIR]   prints how long the parts that measure would take in full, and runs nothing
#
# TIME (default 8m) is for all of it, DEVICE (default gpu) as for --device, PROFILE a profile of the configs, such as
# smoke. In this order it runs doctor, the tests that need features which software drivers lack, conformance and the
# races stressor, the race machine (which needs a C++ compiler), the papers' experiments, the most telling ones first,
# and their claims. Every part has a share of the time; what it does not use goes to the next; tests that passed are
# not run again. If a signal cuts the script off, it ends what runs, which keeps what it has measured. Everything is
# written to DIR, whose size is printed at the end, and once more to DIR/bundle.zip, which `mfr-bench verify` has
# accepted; SIGN_OFF is who vouches for it. MFR is the command, if not that of .venv, and PYTHON runs the tests.
# Exit status 1: a part failed.
set -u
cd "$(dirname "$0")/.." || exit 1
total=${1:-8m} only_forecast=
[ "$total" != forecast ] || { only_forecast=yes total=1h; }  # the time bounds each forecast
dir=${2:-gpu-results} device=${DEVICE:-gpu} profile=${PROFILE:+--profile $PROFILE}
mfr=${MFR:-.venv/bin/mfr-bench} python=${PYTHON:-.venv/bin/python}
case ${total%[smh]} in
    '' | "$total" | *[!0-9]* | 0*) echo "gpu-session: $total: allowed: a whole number with s, m or h, such as 8m" >&2 && exit 2 ;;
esac
case $total in
    *h) budget_s=$((${total%h} * 3600)) ;;
    *m) budget_s=$((${total%m} * 60)) ;;
    *) budget_s=${total%s} ;;
esac
begun_s=$(date +%s)
failed=0 running=
mkdir -p "$dir" || exit 1
bound=
! command -v setpriv >/dev/null || bound="setpriv --pdeathsig TERM"  # what runs ends where this script is killed

# shellcheck disable=SC2329 # by traps
# end_group: ends `timeout` and its command. A `timeout` that gets the signal while it starts its command ends without
# it (coreutils 9.1): what is left of its process group gets the signal as well, and half a minute to end.
end_group() {
    kill "$running" && wait "$running"
    kill -TERM "-$running"
    waited=0
    while kill -0 "-$running" && [ "$waited" -lt 300 ]; do
        sleep 0.1
        waited=$((waited + 1))
    done
    kill -KILL "-$running"
}

# shellcheck disable=SC2329 # by traps
# end_early STATUS: ends what runs, which keeps what it has, and then the script.
end_early() {
    trap '' INT TERM HUP
    [ -z "$running" ] || end_group 2>/dev/null
    echo "== cut off after $(($(date +%s) - begun_s)) s of $budget_s s; the same call goes on: $dir"
    exit "$1"
}
trap 'end_early 130' INT
trap 'end_early 143' TERM
trap 'end_early 129' HUP

# Claims, packing and the bundle have the time that they need at the end set aside.
aside_s=$((budget_s / 20 + 15))

left_s() {
    echo $((budget_s - aside_s - $(date +%s) + begun_s))
}

# part NAME SHARE COMMAND...: COMMAND within SHARE percent of the time, as far as that is left; @ stands for that time.
part() {
    [ -z "$only_forecast" ] || return 0
    name=$1 limit_s=$(($2 * budget_s / 100)) left=$(left_s)
    shift 2
    [ "$limit_s" -le "$left" ] || limit_s=$left
    if [ "$limit_s" -lt 5 ]; then
        echo "== $name: left out, no time"
        return
    fi
    grace_s=0
    for word; do
        shift
        [ "$word" != @ ] || { word=${limit_s}s grace_s=10; }  # it keeps to the time by itself
        set -- "$@" "$word"
    done
    status=0 part_begun_s=$(date +%s)
    # shellcheck disable=SC2086 # $bound is three words or none
    $bound timeout --kill-after=20 $((limit_s + grace_s)) "$@" >"$dir/$name.log" 2>&1 &
    running=$!
    wait "$running" || status=$?
    running=
    case $status in
        124 | 137) ended="cut off" ;;
        *) ended="status $status" ;;
    esac
    out=$(sed -n 's/^left out for the time budget: \([0-9]*\) cells.*/\1/p' "$dir/$name.log" | awk '{ n += $1 } END { print n }')
    echo "== $name: $ended after $(($(date +%s) - part_begun_s)) s, $(left_s) s left; ${out:+$out cells left out; }$(tail -n 1 "$dir/$name.log")"
    [ "$ended" = "cut off" ] || [ "$status" -eq 0 ] || failed=1
}

# once NAME SHARE COMMAND...: a part that is not run again once it has passed in this folder.
once() {
    if [ -e "$dir/$1.passed" ] && [ -z "$only_forecast" ]; then
        echo "== $1: passed before"
        return
    fi
    status=1
    part "$@"
    [ "$status" -ne 0 ] || touch "$dir/$1.passed"
}

# measured NAME SHARE COMMAND...: cells, the coarse points of each experiment before finer ones of any; or their forecast.
measured() {
    name=$1 share=$2
    shift 2
    set -- "$mfr" "$@" --device "$device" --out "$dir/$name"
    if [ -z "$only_forecast" ]; then
        part "$name" "$share" "$@" --time-budget @
    elif plan=$("$@" --dry-run); then
        echo "== $name: $(echo "$plan" | sed -n 's/^  predicted: //p; s/.* to measure in all: //p' | tail -n 1)"
    else
        failed=1
    fi
}

part doctor 10 "$mfr" doctor --device "$device"
once tests 25 "$python" -m pytest -v -p no:cacheprovider tests/gpu tests/contract -k "trial or interlock or native"
# shellcheck disable=SC2086 # $profile is two words or none
measured conformance 25 run device-features conformance $profile
measured races 10 stress races --profile smoke
if command -v "${CXX:-c++}" >/dev/null || command -v g++ >/dev/null || command -v clang++ >/dev/null; then
    part race 5 "$mfr" race all --campaign --schedules 1000 --out "$dir/race"
else
    echo "== race: left out, no C++ compiler"
fi
# shellcheck disable=SC2086
measured kplus 20 run kplus2015-fig6 kplus2015-fig8 kplus2015-fig9-abuffer kplus2015-fig9-sync $profile
# shellcheck disable=SC2086
measured lists 15 run gpupro5-fig3 gpupro5-fig5 sbuffer2012-fig4 adaptive $profile
# shellcheck disable=SC2086
measured others 100 run occupancy2015-fig5 kplus2014-k kplus2015-fig10 twochannel-fig4 $profile
[ -z "$only_forecast" ] || exit "$failed"
aside_s=0
part claims 100 "$mfr" claims "$dir"
part pack 100 "$mfr" pack "$dir"
part bundle 100 "$mfr" submit-results "$dir" --sign-off "${SIGN_OFF:-nobody yet}" --out "$dir/bundle.zip"
part verify 100 "$mfr" verify "$dir/bundle.zip"
echo "== $(du -sh "$dir" | cut -f1) in $dir, $(du -h "$dir/bundle.zip" 2>/dev/null | cut -f1) of it bundle.zip, after $(($(date +%s) - begun_s)) s of $budget_s s"
exit "$failed"
