#!/usr/bin/env bash
# A Slurm cluster of several nodes on this machine, for tests: `scripts/slurm.sh start DIR [NODES]`, `stop DIR`.
# Needs Debian's packages slurmctld, slurmd, slurm-client and munge, and root. Then: export SLURM_CONF=DIR/slurm.conf
set -euo pipefail
command=${1:?start or stop} at=$(realpath -m "${2:?a folder}") nodes=${3:-4}

stop() {
    for name in slurmctld munged "$at"/slurmd.*; do
        pid=$(cat "$at/$(basename "$name" .pid).pid" 2>/dev/null) && kill "$pid" 2>/dev/null || true
    done
}

wait_for() {  # SECONDS COMMAND...
    local left=$1
    shift
    until "$@" >/dev/null 2>&1; do
        ((left-- > 0)) || { echo "$*: no answer" >&2; return 1; }
        sleep 1
    done
}

start() {
    mkdir -p "$at"/{state,spool,munge}
    chmod 700 "$at/munge"
    (umask 077 && head -c 1024 /dev/urandom >"$at/munge/key")
    cat >"$at/slurm.conf" <<EOF
ClusterName=test
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$((port + 0))
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$at/munge/socket
CryptoType=crypto/munge
StateSaveLocation=$at/state
SlurmdSpoolDir=$at/spool/%n
SlurmctldPidFile=$at/slurmctld.pid
SlurmdPidFile=$at/slurmd.%n.pid
SlurmctldLogFile=$at/slurmctld.log
SlurmdLogFile=$at/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SlurmdTimeout=30
KillWait=10
MinJobAge=300
JobRequeue=1
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
SchedulerParameters=bf_interval=2,sched_interval=2
GresTypes=gpu
NodeName=n[1-$nodes] NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=[$((port + 1))-$((port + nodes))] CPUs=1 RealMemory=1000 Gres=gpu:1 State=UNKNOWN
PartitionName=low Nodes=ALL Default=YES MaxTime=INFINITE State=UP PriorityTier=1
PartitionName=high Nodes=ALL MaxTime=INFINITE State=UP PriorityTier=2
EOF
    ln -sf /dev/null "$at/nvidia0"  # Slurm wants a device file, whose number it gives to jobs
    echo "NodeName=n[1-$nodes] Name=gpu File=$at/nvidia0 Flags=nvidia_gpu_env" >"$at/gres.conf"
    export SLURM_CONF=$at/slurm.conf
    munged --force --key-file="$at/munge/key" --socket="$at/munge/socket" --pid-file="$at/munged.pid" \
        --log-file="$at/munged.log" --seed-file="$at/munge/seed"
    slurmctld -c -f "$SLURM_CONF"
    for ((i = 1; i <= nodes; i++)); do slurmd -N "n$i" -f "$SLURM_CONF"; done
    wait_for 60 bash -c "[ \$(sinfo -h -N -t idle -p low | wc -l) = $nodes ]"
}

port=$((20000 + RANDOM % 20000))
case $command in
    start) start ;;
    stop) stop ;;
    *) echo "$command: allowed: start, stop" >&2; exit 2 ;;
esac
