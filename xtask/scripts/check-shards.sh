#!/bin/sh
# Runs a few studies, or a sweep, whole and in shares, joins the shares, and compares what was written,
# bit for bit except for wall times. From the repository's root:
#
#   xtask/scripts/check-shards.sh parallel           shares by GNU parallel
#   xtask/scripts/check-shards.sh slurm              shares by a Slurm job array, on a node of its own
#   xtask/scripts/check-shards.sh parallel sweep     those of a sweep
#
# The second needs Debian's slurm-wlm and munge, and root: it starts a controller and a node in a
# folder of its own, and ends them again.
set -eu

how="${1:?parallel or slurm}"
what="${2:-report}"
here="$(pwd)"
work="$(mktemp -d)"
shares=4
studies="one-step derivative-check newton-initial-guesses newton-wrong-derivatives pendulum-convergence table-4-1"
only="$(for study in $studies; do printf -- '--only %s ' "$study"; done)"
cargo build --quiet --package xtask
case "$what" in
    report) run="$here/target/debug/xtask report --quiet $only" ;;
    sweep)
        run="$here/target/debug/xtask sweep $work/spring.toml --quiet --set k=0:20:11 --set m=0:2:3"
        cat > "$work/spring.toml" <<SCENE
dimension = 1
integrator = "stormer-verlet"
step = 0.01
horizon = 4
observables = [{ position = "mass" }]
particles = [
    { name = "wall", position = [0], pinned = true },
    { name = "mass", position = [1], velocity = [1], mass = "= m" },
]
springs = [{ between = ["wall", "mass"], stiffness = "= k" }]
parameters = { k = 1, m = 1 }
SCENE
        ;;
    *) echo "$what: report or sweep" >&2; exit 2 ;;
esac

by_parallel() {
    parallel "$run --shard {}/$shares --out $work/shards/{}" ::: $(seq $shares)
}

# A controller and a node, both of this machine.
start_slurm() {
    host="$(hostname -s)"
    mkdir -p "$work/state" "$work/spool" /run/munge /var/log/munge
    [ -f /etc/munge/munge.key ] || dd if=/dev/urandom of=/etc/munge/munge.key bs=1024 count=1 2>/dev/null
    chown -R munge: /etc/munge /run/munge /var/log/munge /var/lib/munge
    chmod 400 /etc/munge/munge.key
    su -s /bin/sh munge -c 'munged --force'
    cat > "$work/slurm.conf" <<CONF
ClusterName=check
SlurmctldHost=$host
SlurmUser=root
AuthType=auth/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
ReturnToService=2
NodeName=$host CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=60 State=UP
CONF
    export SLURM_CONF="$work/slurm.conf"
    slurmctld
    slurmd
}

end_slurm() {
    for daemon in slurmd slurmctld; do
        [ ! -f "$work/$daemon.pid" ] || kill "$(cat "$work/$daemon.pid")"
    done
    [ ! -f /run/munge/munged.pid ] || kill "$(cat /run/munge/munged.pid)"
}

by_slurm() {
    trap end_slurm EXIT
    start_slurm
    sbatch --wait --array=1-$shares --chdir="$work" --output="$work/%a.log" --export=ALL <<JOB
#!/bin/sh
exec $run --shard \$SLURM_ARRAY_TASK_ID/\$SLURM_ARRAY_TASK_COUNT --out $work/shards/\$SLURM_ARRAY_TASK_ID
JOB
}

# A table without its wall times.
deterministic() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) keep[i] = $i !~ /\[s\]|wall/ }
        { line = ""; for (i = 1; i <= NF; i++) if (keep[i]) line = line "," $i; print line }' "$1"
}

$run --out "$work/whole"
"by_$how"
target/debug/xtask merge --quiet "$work"/shards/* --out "$work/joined"
compared=0
for table in "$work"/whole/*.csv; do
    deterministic "$table" > "$work/a"
    deterministic "$work/joined/$(basename "$table")" > "$work/b"
    cmp "$work/a" "$work/b"
    compared=$((compared + 1))
done
[ "$what" = report ] || cmp "$work/whole/sweep.svg" "$work/joined/sweep.svg"
echo "$compared tables of $shares shares by $how are those of one run, bit for bit"
