#!/usr/bin/env bash
# Work shared over MPI ranks, from outside: the same bytes as one process makes, clean ends, continued runs.
# Usage: ranks_test.sh PATH_OF_REPRISE [PATH_OF_MPIRUN]; without mpirun it exits with 77, which counts as skipped.
set -u
reprise=$1
if [ -z "${2:-}" ]; then
  echo "skipped: this Reprise was built without MPI (install libopenmpi-dev and openmpi-bin, configure anew)"
  exit 77
fi
mpirun=("$2" --allow-run-as-root --oversubscribe -np 2)
# Open MPI keeps some memory to the end; that is not ours to find.
export ASAN_OPTIONS="${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0

fail() {
  echo "FAILED: $1"
  [ -f out.txt ] && sed 's/^/    /' out.txt
  failures=$((failures + 1))
}

# expect CODE "text in the output" COMMAND...; a command that hangs is killed and fails.
expect() {
  local code=$1 text=$2
  shift 2
  timeout -k 5 120 "$@" > out.txt 2>&1
  local got=$?
  [ "$got" -eq "$code" ] || fail "exit code $got, expected $code: $*"
  grep -qF -- "$text" out.txt || fail "the output lacks '$text': $*"
}
said_once() {
  local count
  count=$(grep -cF -- "$1" out.txt)
  [ "$count" -eq 1 ] || fail "'$1' was said $count times, expected once"
}
# The one matrix that is kept of a metric, set aside as NAME.
keep_matrix() { mv db.reprise.cache/"$1"-*.matrix "$2" || fail "no matrix of $1 was kept"; }
same() { cmp -s "$1" "$2" || fail "$1 and $2 differ"; }

# Two clips; coarse histograms, for speed.
"$reprise" perform --costume figure -o figure.reprise --voxel-size 0.07 > out.txt 2>&1 || fail "no figure"
for clip in walk stand; do
  "$reprise" export figure.reprise --clip $clip -o $clip --format ply > out.txt 2>&1 || fail "no clip"
done
"$reprise" import db.reprise --sequence walk=walk --sequence stand=stand > out.txt 2>&1 || fail "no database"
coarse=(--bins '3,4,8,2,2,2' --refinement 4 --voxel 0.1)

# One process and two ranks, threads and all
for metric in shape-colour shape; do
  expect 0 "transitions" "$reprise" similarity db.reprise --metric $metric "${coarse[@]}"
  keep_matrix $metric alone
  expect 0 "transitions" "${mpirun[@]}" "$reprise" similarity db.reprise --metric $metric "${coarse[@]}"
  said_once "metric $metric"
  keep_matrix $metric shared
  same alone shared
done
expect 0 "graph.json" "$reprise" graph db.reprise -o graph.json --metric shape "${coarse[@]}"
keep_matrix shape alone
mv graph.json alone.json
expect 0 "graph.json" "${mpirun[@]}" "$reprise" graph db.reprise -o graph.json --metric shape "${coarse[@]}"
said_once "graph.json"
keep_matrix shape shared
same alone shared
same alone.json graph.json
expect 0 "metric vertex" "${mpirun[@]}" "$reprise" similarity db.reprise --metric vertex
said_once "metric vertex"

# Killed in the middle, alone and as ranks, and continued by the other
exact=(similarity db.reprise --metric shape --exact "${coarse[@]}")
expect 0 "transitions" "$reprise" "${exact[@]}"
keep_matrix shape whole
# start_and_kill SIGNAL COMMAND...: once something has been kept
start_and_kill() {
  local signal=$1
  shift
  "$@" > out.txt 2>&1 &
  local job=$!
  while kill -0 $job 2> kill.txt && ! compgen -G "db.reprise.cache/shape-*.matrix" > found.txt; do sleep 0.02; done
  kill -"$signal" $job 2> kill.txt
  wait $job 2> kill.txt
  compgen -G "db.reprise.cache/shape-*.matrix" > found.txt || fail "nothing was kept of a run that was stopped"
}
start_and_kill KILL "$reprise" "${exact[@]}"
expect 0 "transitions" "${mpirun[@]}" "$reprise" "${exact[@]}"
keep_matrix shape continued
same whole continued
start_and_kill TERM "${mpirun[@]}" "$reprise" "${exact[@]}"
expect 0 "transitions" "$reprise" "${exact[@]}"
keep_matrix shape continued
same whole continued

# An error of all is said once; of one it ends them all
expect 1 "nowhere.reprise" "${mpirun[@]}" "$reprise" similarity nowhere.reprise
said_once "reprise: error"
expect 1 "did you mean 'shape'" "${mpirun[@]}" "$reprise" similarity db.reprise --metric shap
said_once "reprise: error"
expect 2 "required" "${mpirun[@]}" "$reprise" similarity
said_once "database is required"
cat > one_bad.sh <<'END'
#!/usr/bin/env bash
database=db.reprise
[ "$OMPI_COMM_WORLD_RANK" = 0 ] || database=nowhere.reprise
exec "$1" similarity $database --metric shape --no-cache --exact --bins 3,4,8,2,2,2 --refinement 4 --voxel 0.1
END
chmod +x one_bad.sh
expect 1 "on rank 1" "${mpirun[@]}" ./one_bad.sh "$reprise"

# Motions: whole ones a rank, the same files and tables as one process writes
"$reprise" skeleton figure.reprise -o bvh > out.txt 2>&1 || fail "no motions"
"$reprise" graph figure.reprise -o figure.json > out.txt 2>&1 || fail "no graph"
mkdir corpus && mv bvh corpus/bvh
printf 'trial,class\nwalk,walk\nstop,walk\njog,run\nnobody,run\n' > corpus/index.csv
echo "HIERARCHY" > corpus/bvh/nobody.bvh
drive=(mocap figure.reprise --graph figure.json --no-deform --corpus corpus/index.csv)
expect 1 "3 of 4 motions" "$reprise" "${drive[@]}" -o alone_motions
expect 1 "3 of 4 motions" "${mpirun[@]}" "$reprise" "${drive[@]}" -o shared_motions
said_once "3 of 4 motions"
for clip in walk stop jog; do same alone_motions/$clip.reprise shared_motions/$clip.reprise; done
tables=(evaluate mocap figure.reprise --graph figure.json --no-deform --corpus corpus/index.csv)
expect 1 "| walks | 2 of 2 |" "$reprise" "${tables[@]}" -o alone_tables
expect 1 "| walks | 2 of 2 |" "${mpirun[@]}" "$reprise" "${tables[@]}" -o shared_tables
said_once "| walks | 2 of 2 |"
for file in mocap.csv walks.png runs.png; do same alone_tables/$file shared_tables/$file; done

# Work that is not shared
expect 2 "'evaluate naturalness' does not share" "${mpirun[@]}" "$reprise" evaluate naturalness figure.reprise --database figure.reprise
said_once "does not share its work"
expect 2 "does not share its work" "${mpirun[@]}" "$reprise" info db.reprise
said_once "does not share its work"
expect 0 "walk" "${mpirun[@]:0:3}" -np 1 "$reprise" info db.reprise

[ $failures -eq 0 ] && echo "all checks passed"
exit $((failures > 0))
