#!/usr/bin/env bash
# The program from outside: exit codes, messages, and what is left on disk. Usage: cli_test.sh PATH_OF_REPRISE
set -u
reprise=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0

fail() {
  echo "FAILED: $1"
  [ -f out.txt ] && sed 's/^/    /' out.txt
  failures=$((failures + 1))
}

# expect CODE "text in the output" COMMAND...
expect() {
  local code=$1 text=$2
  shift 2
  "$@" > out.txt 2>&1
  local got=$?
  [ "$got" -eq "$code" ] || fail "exit code $got, expected $code: $*"
  grep -qF -- "$text" out.txt || fail "the output lacks '$text': $*"
}

# unchanged FILE: the file still has the content it had when `keep FILE` was called.
keep() { cp "$1" "$1.kept"; }
unchanged() { cmp -s "$1" "$1.kept" || fail "$1 was changed by a command that failed"; }
no_partial_files() {
  local left
  left=$(find . -name '*.partial-*')
  [ -z "$left" ] || fail "half-written files are left: $left"
}

# A small performance to work on.
expect 0 "figure.reprise" "$reprise" perform --costume figure -o figure.reprise --voxel-size 0.06
expect 0 "walk" "$reprise" info figure.reprise
expect 0 '"format_version": 2' "$reprise" info figure.reprise --json
expect 0 "usable" "$reprise" validate figure.reprise
expect 0 "metric vertex" "$reprise" similarity figure.reprise --metric vertex
expect 0 "kept from an earlier run" "$reprise" similarity figure.reprise --metric vertex
expect 0 "transitions" "$reprise" graph figure.reprise -o graph.json
expect 0 "proved optimal" "$reprise" keyframes figure.reprise --graph graph.json --from stand:5 --to wave:20 \
  --distance 6 --time 6 -o new.reprise --report report.json
expect 0 "pop ratio" "$reprise" evaluate naturalness new.reprise --database figure.reprise
expect 0 '"captured_foot_drift_cm_s"' "$reprise" evaluate naturalness new.reprise --database figure.reprise --json
expect 0 "new.glb" "$reprise" export new.reprise -o new.glb
expect 0 "new.pc2" "$reprise" export new.reprise -o new.pc2
expect 0 "frames" "$reprise" export figure.reprise --clip walk -o walk --format obj
expect 0 "frames" "$reprise" export figure.reprise --clip stand -o stand --format ply

# All that a key-frame query can ask for
asked=(keyframes figure.reprise --graph graph.json --from stand:5 --to wave:20)
expect 0 "turned by" "$reprise" "${asked[@]}" --distance 6 --time 8 --goal 3,4 --turn 30 --max-time 12 -o asked.reprise --report asked.json
expect 0 '"position"' cat asked.json
expect 0 "turned by" "$reprise" "${asked[@]}" --distance 5 --time 6 --route 0,0 0,4 -o asked.reprise
expect 0 "animation-2" "$reprise" "${asked[@]}" --distance 4 --time 6 --alternatives 2 -o asked.reprise
expect 0 "corrected: distance 4.000 m, time 6.00 s" "$reprise" "${asked[@]}" --distance 4 --time 6 --correct -o asked.reprise
expect 0 "proved optimal" "$reprise" "${asked[@]}" --distance 4 --time 6 --require walk --forbid jog --slide-feet --lp asked.lp -o asked.reprise
expect 0 "Minimize" cat asked.lp
keep asked.reprise
expect 1 "contradict" "$reprise" "${asked[@]}" --min-time 9 --max-time 8 -o asked.reprise
expect 1 "keeps the limits" "$reprise" "${asked[@]}" --max-time 0.1 -o asked.reprise
expect 1 "both compulsory and forbidden" "$reprise" "${asked[@]}" --require walk --forbid walk -o asked.reprise
expect 1 "which is forbidden" "$reprise" "${asked[@]}" --forbid stand -o asked.reprise
expect 1 "distance weight" "$reprise" "${asked[@]}" --distance-weight -1 -o asked.reprise
expect 1 "time weight" "$reprise" "${asked[@]}" --time-weight nan -o asked.reprise
expect 1 "expected a point on the ground" "$reprise" "${asked[@]}" --goal 3 -o asked.reprise
expect 1 "--turn is given without --goal" "$reprise" "${asked[@]}" --turn 90 -o asked.reprise
expect 1 ".lp" "$reprise" "${asked[@]}" --lp query.txt -o asked.reprise
unchanged asked.reprise

# Play
expect 0 "pop ratio" "$reprise" play figure.reprise --graph graph.json --from stand:5 --time 10 -o play.reprise --report play.json
expect 0 '"mode": "stochastic"' cat play.json
expect 0 "the loop lasts" "$reprise" play figure.reprise --graph graph.json --from stand:5 --mode loop --time 10 -o play.reprise
expect 0 "the loop lasts" "$reprise" play figure.reprise --graph graph.json --from stand:5 --mode period -o play.reprise
expect 0 "pop ratio" "$reprise" evaluate naturalness play.reprise --database figure.reprise
keep play.reprise
expect 1 "ends in a dead end" "$reprise" play figure.reprise --graph graph.json --from stand:5 --max-cost 0 -o play.reprise
expect 1 "temperature: expected a number of at least 0" "$reprise" play figure.reprise --graph graph.json --from stand:5 --temperature -1 -o play.reprise
expect 1 "did you mean 'stand'" "$reprise" play figure.reprise --graph graph.json --from stand:5 --without stnad -o play.reprise
expect 1 "not written over" "$reprise" play figure.reprise --graph graph.json --from stand:5 -o figure.reprise
expect 2 "--mode" "$reprise" play figure.reprise --graph graph.json --from stand:5 --mode lop -o play.reprise
unchanged play.reprise

# What a performer cannot do is said before the long work begins.
expect 1 "'nobody'" "$reprise" perform --costume nobody -o no.reprise
expect 1 "nowhere" "$reprise" perform --makehuman nowhere -o no.reprise
expect 1 "vertices: expected 1000 to 50000, found 10" "$reprise" perform --vertices 10 -o no.reprise
expect 1 "noise is -1" "$reprise" perform --noise -1 -o no.reprise
expect 1 "expected a .bvh or .amc file" "$reprise" perform --motion walk.fbx -o no.reprise
expect 1 "does not exist" "$reprise" perform --motion walk.amc -o no.reprise
: > walk.amc
expect 1 "needs its skeleton" "$reprise" perform --motion walk.amc -o no.reprise
rm walk.amc
expect 1 "no motion file" "$reprise" perform --skeleton walk.asf -o no.reprise
expect 1 "its own clips only" "$reprise" perform --costume figure --motion walk.bvh -o no.reprise
echo '{"based_on": "fashion1", "garment": []}' > bad.json
expect 1 "garment" "$reprise" perform --costume bad.json -o no.reprise
[ ! -e no.reprise ] || fail "a performance that failed left a file"

# Markup and skeletons
expect 0 "19 joints" "$reprise" info figure.reprise
expect 0 "degrees from the truth" "$reprise" skeleton figure.reprise -o bvh --report skeleton.json
expect 0 "HIERARCHY" cat bvh/walk.bvh
expect 0 '"mean_angle_degrees"' cat skeleton.json
expect 0 "walk" "$reprise" skeleton figure.reprise --clip walk --position centroid
expect 0 "markup.json: 19 joints, 6 parts" "$reprise" markup figure.reprise --write-json markup.json
expect 0 "marked.reprise: 19 joints" "$reprise" markup figure.reprise --file markup.json -o marked.reprise
cmp -s figure.reprise marked.reprise || fail "a markup written and read back changed the database"
expect 0 "19 joints" "$reprise" info new.reprise
expect 1 "did you mean 'walk'" "$reprise" skeleton figure.reprise --clip wlak
expect 1 "another.txt: expected a name that ends in .json" "$reprise" skeleton figure.reprise --report another.txt
expect 1 "expected landmarks, a markup file or parts" "$reprise" markup figure.reprise -o marked.reprise
expect 1 "nothing to do" "$reprise" markup figure.reprise
expect 2 "excludes" "$reprise" markup figure.reprise --file markup.json --landmarks markup.json -o marked.reprise
expect 1 "is not a landmark file" "$reprise" markup figure.reprise --landmarks markup.json -o marked.reprise
echo '{"format": "reprise landmarks", "version": 1, "landmarks": {"nose": 3}}' > landmarks.json
expect 1 "names no frame" "$reprise" markup figure.reprise --landmarks landmarks.json -o marked.reprise
expect 1 "there is no landmark 'nose'" "$reprise" markup figure.reprise --landmarks landmarks.json --frame walk:0 \
  -o marked.reprise
expect 1 "not written over" "$reprise" markup figure.reprise --file markup.json -o figure.reprise

# Models of deformation, measured
expect 0 "| 12 | part |" "$reprise" evaluate deformation figure.reprise --held wave --every 20 --constraints 12 \
  --count 12 --pictures 1 -o deformation
for file in deformation.md deformation.csv frames.csv deformation.png pictures.png; do
  [ -s "deformation/$file" ] || fail "evaluate deformation wrote no $file"
done
expect 1 "there is no clip" "$reprise" evaluate deformation figure.reprise --held nobody -o deformation
expect 1 "did you mean 'part'" "$reprise" evaluate deformation figure.reprise --model prat -o deformation
expect 1 "name both or none" "$reprise" perform --motion walk.bvh --limbs left_upper_arm -o limbs.reprise
expect 1 "none for the body" "$reprise" perform --limbs-from walk.bvh --limbs left_upper_arm -o limbs.reprise

# Editing
cat > hand.json <<'EOS'
{"format": "reprise edit", "version": 1, "model": "laplacian", "steps": [
  {"anchors": [{"part": "torso"}], "handles": [{"joint": "left_upper_arm", "move": [0, 0.05, 0.05]}]},
  {"handles": [{"joint": "head", "turn": {"axis": [0, 1, 0], "degrees": 20}}]}]}
EOS
edit=(edit figure.reprise --script hand.json --frame walk:16 -o edited.reprise)
expect 0 "clip 'edit', 1 frame, model laplacian" "$reprise" "${edit[@]}" --report edit.json --picture edit.png
expect 0 '"residual"' cat edit.json
expect 0 "PNG" head -c 8 edit.png
expect 0 "19 joints" "$reprise" info edited.reprise
expect 0 "clip 'edit', 3 frames" "$reprise" "${edit[@]}" --steps
expect 0 "clip 'edit', 1 frame, model lbs" "$reprise" "${edit[@]}" --model lbs
expect 0 "clip 'walk'" "$reprise" "${edit[@]}" --window 0.2 --model dqs
expect 0 "pop ratio" "$reprise" "${edit[@]}" --window 0.2
expect 0 "pop ratio" "$reprise" evaluate naturalness edited.reprise --database figure.reprise
keep edited.reprise
expect 1 "names no frame" "$reprise" edit figure.reprise --script hand.json -o edited.reprise
expect 1 "did you mean 'walk'" "$reprise" edit figure.reprise --script hand.json --frame wlak:1 -o edited.reprise
sed 's/left_upper_arm/left_uper_arm/' hand.json > typo.json
expect 1 "typo.json:steps[0].handles[0]: " "$reprise" edit figure.reprise --script typo.json --frame walk:16 -o edited.reprise
grep -qF "did you mean 'left_upper_arm'" out.txt || fail "a typo in a script got no suggestion"
expect 1 "is not an edit script" "$reprise" edit figure.reprise --script markup.json --frame walk:16 -o edited.reprise
expect 1 "model learn" "$reprise" "${edit[@]}" --model part
expect 1 "window: expected" "$reprise" "${edit[@]}" --window -1
expect 1 "not written over" "$reprise" edit figure.reprise --script hand.json --frame walk:16 -o figure.reprise
expect 1 ".png" "$reprise" "${edit[@]}" --picture edit.jpg
expect 2 "--model" "$reprise" "${edit[@]}" --model clay
expect 2 "excludes" "$reprise" "${edit[@]}" --steps --window 1
unchanged edited.reprise

# Learning
expect 0 "whole model: examples in" "$reprise" model learn figure.reprise --count 6 --without jog,wave -o learnt.reprise \
  --report learnt.json --write-examples examples.json
expect 0 '"covering_radius"' cat learnt.json
expect 0 "part model: torso (" "$reprise" info learnt.reprise
expect 0 '"format_version": 3' "$reprise" info learnt.reprise --json
expect 0 "walk:" cat examples.json
cp learnt.reprise again.reprise
expect 0 "again.reprise" "$reprise" model learn again.reprise --examples examples.json
cmp -s learnt.reprise again.reprise || fail "a list of examples learnt something else than the choice it was written from"
expect 0 "left_shin" "$reprise" model learn figure.reprise --parts limbs --model part --count 3 -o limbs.reprise
expect 0 "left_arm" "$reprise" model learn figure.reprise --parts markup.json --model part --count 3 -o learnt2.reprise
expect 0 "relabelled.reprise" "$reprise" markup learnt.reprise --parts limbs -o relabelled.reprise
expect 0 "part model: torso (" "$reprise" info relabelled.reprise
expect 0 "model part" "$reprise" edit learnt.reprise --script hand.json --frame walk:16 -o edited.reprise --model part
keep learnt.reprise
learn=(model learn learnt.reprise --count 3)
expect 1 "did you mean 'wave'" "$reprise" "${learn[@]}" --without wvae
echo '{"format": "reprise examples", "version": 1, "parts": {"torso": ["walk:0"]}}' > torso.json
expect 1 "torso.json: names no example for part 'head'" "$reprise" "${learn[@]}" --examples torso.json
sed 's/walk:0/wlak:0/' torso.json > typo.json
expect 1 "did you mean 'walk'" "$reprise" "${learn[@]}" --examples typo.json
expect 1 "nowhere.json" "$reprise" "${learn[@]}" --examples nowhere.json
expect 1 "expected six, limbs or whole" "$reprise" "${learn[@]}" --parts eight
expect 1 "is not a markup file" "$reprise" "${learn[@]}" --parts examples.json
expect 1 "not written over" "$reprise" "${learn[@]}" -o ./learnt.reprise
expect 1 ".reprise" "$reprise" "${learn[@]}" -o learnt.h5
expect 2 "--count" "$reprise" "${learn[@]}" --count 0
expect 2 "--keep" "$reprise" "${learn[@]}" --keep 1.5
expect 2 "subcommand" "$reprise" model
unchanged learnt.reprise

# Motion capture: the figure performs its own skeleton, and what others would get wrong
mocap=(mocap learnt.reprise --graph graph.json)
expect 0 "0 transitions, 0 repeats, 0 skips" "$reprise" "${mocap[@]}" --motion bvh/walk.bvh -o driven.reprise --report driven.json \
  --write-drive-vertices drive.json
for field in '"velocity_error_cm_frame"' '"joint_map"' '"foot_drift_cm_s"' '"path_time"' '"frames_per_second"'; do
  expect 0 "$field" grep -F "$field" driven.json
done
expect 0 "walk" "$reprise" info driven.reprise
expect 0 "pop ratio" "$reprise" evaluate naturalness driven.reprise --database figure.reprise
expect 0 "learnt now" "$reprise" mocap figure.reprise --graph graph.json --motion bvh/wave.bvh -o unlearnt.reprise
expect 0 "step" "$reprise" "${mocap[@]}" --motion bvh/walk.bvh --no-deform --timing repeats --name step -o raw.reprise
expect 0 "walk-2" "$reprise" "${mocap[@]}" --motion bvh/walk.bvh --model lbs --alternatives 2 --threshold 9 -o two.reprise
expect 0 "frames/s" "$reprise" "${mocap[@]}" --motion bvh/walk.bvh --drive-vertices drive.json -o again.reprise
cmp -s driven.reprise again.reprise || fail "drive vertices written and read back drive otherwise"
expect 0 "2 of 2 motions" "$reprise" "${mocap[@]}" --motion bvh/walk.bvh --motion bvh/wave.bvh -o many --report many.json
cmp -s driven.reprise many/walk.reprise || fail "one motion of many has other bytes than alone"
mkdir -p corpus/bvh && cp bvh/walk.bvh bvh/stop.bvh corpus/bvh && echo "HIERARCHY" > corpus/bvh/bad.bvh
printf 'trial,class,description,tier\nwalk,walk,"walk, on",good\nstop,walk,stop,good\nbad,run,bad,poor\n' > corpus/index.csv
expect 0 "1 of 1 motions" "$reprise" "${mocap[@]}" --corpus corpus/index.csv --trials stop -o corpus_out
expect 1 "2 of 3 motions" "$reprise" "${mocap[@]}" --corpus corpus/index.csv -o corpus_out
expect 0 "| walks | 2 of 2 |" "$reprise" evaluate mocap learnt.reprise --graph graph.json --corpus corpus/index.csv \
  --tiers good -o mocap_tables --held stop=stop --threshold 9
for file in mocap.md mocap.csv times.csv walks.png truth.csv truth.png; do
  [ -s "mocap_tables/$file" ] || fail "evaluate mocap wrote no $file"
done
expect 1 "## Failures" "$reprise" evaluate mocap learnt.reprise --graph graph.json --corpus corpus/index.csv --trials bad -o mocap_tables
expect 1 "expected CLIP=TRIAL" "$reprise" evaluate mocap learnt.reprise --graph graph.json --corpus corpus/index.csv --held walk -o mocap_tables
keep driven.reprise
drive=("${mocap[@]}" -o driven.reprise --motion)
expect 1 "no retrieval" "$reprise" "${drive[@]}" bvh/walk.bvh --threshold 0.000001
expect 1 "nowhere.bvh" "$reprise" "${drive[@]}" nowhere.bvh
expect 1 "expected a .bvh or .amc file" "$reprise" "${drive[@]}" walk.fbx
awk '/^[ \t]*(ROOT|JOINT) /{ sub(/[^ ]+$/, "bone" NR) } { print }' bvh/walk.bvh > strange.bvh
expect 1 "bone2" "$reprise" "${drive[@]}" strange.bvh
echo '{"joints": {"left_thigh": "nobody"}}' > map.json
expect 1 "nobody" "$reprise" "${drive[@]}" bvh/walk.bvh --map map.json
echo '{"joints": {"left_thingh": "left_thigh"}}' > map.json
expect 1 "left_thigh" "$reprise" "${drive[@]}" bvh/walk.bvh --map map.json
sed '/^Frames:/,$d' bvh/walk.bvh > empty.bvh
printf 'Frames: 0\nFrame Time: 0.04\n' >> empty.bvh
expect 1 "empty.bvh" "$reprise" "${drive[@]}" empty.bvh
awk 'done || !/^Frame Time/ { print } /^Frame Time/ { print; getline; sub(/^[^ ]+/, "nan"); print; done = 1 }' bvh/walk.bvh > nan.bvh
expect 1 "nan.bvh" "$reprise" "${drive[@]}" nan.bvh
sed 's/^Frame Time:.*/Frame Time: 0/' bvh/walk.bvh > rateless.bvh
expect 1 "rateless.bvh" "$reprise" "${drive[@]}" rateless.bvh
expect 1 "m tall" "$reprise" "${drive[@]}" bvh/walk.bvh --motion-scale 1
cat > man.asf <<'END'
:version 1.10
:units
  length 0.45
  angle deg
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
    id 1
    name lfemur
    direction 0 -1 0
    length 7
    axis 0 0 0 XYZ
    dof rx ry rz
  end
:hierarchy
  begin
    root lfemur
  end
END
printf ':FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 16 0 0 0 0\nrfemur 0 0 0\n' > man.amc
expect 1 "rfemur" "$reprise" "${drive[@]}" man.amc --skeleton man.asf
printf ':FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 16 0 0 0 0\nlfemur 0 0\n' > man.amc
expect 1 "man.amc" "$reprise" "${drive[@]}" man.amc --skeleton man.asf
mkdir lonely && cp man.amc lonely/07_01.amc
expect 1 "needs its skeleton" "$reprise" "${drive[@]}" lonely/07_01.amc
expect 1 "without an .amc file" "$reprise" "${drive[@]}" bvh/walk.bvh --skeleton man.asf
expect 1 "expected a --motion or a --corpus" "$reprise" "${mocap[@]}" -o driven.reprise
expect 1 "choose from a --corpus" "$reprise" "${drive[@]}" bvh/walk.bvh --tiers core
expect 1 "did you mean 'good'" "$reprise" "${mocap[@]}" --corpus corpus/index.csv --tiers god -o corpus_out
expect 1 "did you mean 'walk'" "$reprise" "${drive[@]}" bvh/walk.bvh --without wlak
expect 1 "not written over" "$reprise" mocap learnt.reprise --graph graph.json --motion bvh/walk.bvh -o learnt.reprise
expect 1 "not written over" "$reprise" "${drive[@]}" bvh/walk.bvh --report graph.json
expect 1 ".png" "$reprise" "${drive[@]}" bvh/walk.bvh --strip strip.jpg
expect 1 "two motions are called 'walk'" "$reprise" "${mocap[@]}" --motion bvh/walk.bvh --motion corpus/bvh/walk.bvh -o many
expect 2 "--model" "$reprise" "${drive[@]}" bvh/walk.bvh --model clay
expect 2 "--alternatives" "$reprise" "${drive[@]}" bvh/walk.bvh --alternatives 0
unchanged driven.reprise
no_partial_files

# The command line itself
expect 2 "subcommand" "$reprise"
expect 2 "there is no command 'nonsense'" "$reprise" nonsense
expect 2 "did you mean 'keyframes'" "$reprise" keyframe
expect 2 "--output is required" "$reprise" graph figure.reprise
for command in perform import info validate markup skeleton similarity graph keyframes mocap play edit export render "model learn" "evaluate naturalness" "evaluate keyframes" "evaluate deformation" "evaluate mocap"; do
  # shellcheck disable=SC2086
  expect 0 "OPTIONS" "$reprise" $command --help
done
expect 0 "FLOAT=0.3" "$reprise" evaluate naturalness --help

# Missing and unreadable frames, gaps, other vertex counts and faces
expect 1 "nowhere" "$reprise" import db.reprise --sequence a=nowhere
mkdir empty
expect 1 "empty" "$reprise" import db.reprise --sequence a=empty
cp -r walk gap
rm "gap/$(ls gap | sed -n 5p)"
expect 1 "$(ls walk | sed -n 5p | grep -oE '[0-9]+' | sed 's/^0*//')" "$reprise" import db.reprise --sequence a=gap
cp -r walk fewer
sed -i '0,/^v /{/^v /d}' "fewer/$(ls fewer | sed -n 4p)"
expect 1 "$(ls fewer | sed -n 4p)" "$reprise" import db.reprise --sequence a=fewer
cp -r walk faces
awk '/^f / && !done { print $1, $3, $2, $4; done = 1; next } { print }' "walk/$(ls walk | sed -n 6p)" \
  > "faces/$(ls walk | sed -n 6p)"
expect 1 "triangle 0" "$reprise" import db.reprise --sequence a=faces
cp -r walk nan
sed -i '0,/^v .*/s//v nan 0 0/' "nan/$(ls nan | sed -n 3p)"
expect 1 "$(ls nan | sed -n 3p)" "$reprise" import db.reprise --sequence a=nan
expect 1 "not usable" "$reprise" validate nan
cp -r walk flat
sed -i -E 's/^v [^ ]+ [^ ]+ [^ ]+/v 1 2 3/' "flat/$(ls flat | sed -n 2p)"
expect 1 "area" "$reprise" import db.reprise --sequence a=flat
cp -r stand short
truncate -s 300 "short/$(ls short | sed -n 7p)"
expect 1 "$(ls short | sed -n 7p)" "$reprise" import db.reprise --sequence a=short
truncate -s 1000 new.pc2
expect 1 "new.pc2" "$reprise" import db.reprise --sequence a=new.pc2,topology=new.ply
[ ! -e db.reprise ] || fail "a failed import left a database"
no_partial_files

# Database files: truncated, foreign, of a later version; never written over something else
head -c 5000 figure.reprise > cut.reprise
expect 1 "cut.reprise" "$reprise" info cut.reprise
echo "not a database" > foreign.reprise
expect 1 "foreign.reprise" "$reprise" info foreign.reprise
keep foreign.reprise
expect 1 "foreign.reprise" "$reprise" import foreign.reprise --sequence a=walk
unchanged foreign.reprise

# Key-frames and graphs
keep new.reprise
expect 1 "did you mean 'walk'" "$reprise" keyframes figure.reprise --graph graph.json --from wlak:1 --to wave:2 -o new.reprise
expect 1 "asked for 9999" "$reprise" keyframes figure.reprise --graph graph.json --from walk:9999 --to wave:2 -o new.reprise
expect 1 "CLIP:FRAME" "$reprise" keyframes figure.reprise --graph graph.json --from walk --to wave:2 -o new.reprise
"$reprise" export figure.reprise --clip stand -o stand_obj --format obj > out.txt 2>&1 || fail "export of OBJ"
expect 0 "2 clips imported" "$reprise" import pair.reprise --sequence walk=walk --sequence stand=stand_obj -v
expect 1 "has no markup" "$reprise" skeleton pair.reprise
expect 1 "has no markup" "$reprise" model learn pair.reprise
expect 0 "body" "$reprise" model learn pair.reprise --model whole --count 4 -o pair_learnt.reprise

# Similarity: every metric, and what it asks for
coarse=(--bins '3,4,8,2,2,2' --refinement 2 --voxel 0.1)
expect 0 "metric skeleton" "$reprise" similarity figure.reprise --metric skeleton
expect 0 "pairs exact, the others between bounds" "$reprise" similarity pair.reprise --metric shape-color "${coarse[@]}"
expect 0 "transport problems solved" "$reprise" similarity pair.reprise --metric shape --exact "${coarse[@]}"
expect 0 "kept from an earlier run" "$reprise" similarity pair.reprise --metric shape --exact "${coarse[@]}"
expect 0 "heat.png" "$reprise" similarity pair.reprise --metric shape "${coarse[@]}" --picture heat.png
expect 0 "transitions" "$reprise" graph pair.reprise -o shape.json --metric shape "${coarse[@]}" --transitions-per-pair 2
expect 0 '"metric": "shape"' cat shape.json
expect 1 "did you mean 'vertex'" "$reprise" similarity pair.reprise --metric vertx
expect 1 "the metrics are shape-colour, shape, vertex, skeleton" "$reprise" graph pair.reprise -o no.json --metric mood
expect 1 "give it one with \`reprise markup\`" "$reprise" similarity pair.reprise --metric skeleton
expect 2 "--bins" "$reprise" similarity pair.reprise --metric shape --bins 3,4,8
expect 2 "--bins" "$reprise" similarity pair.reprise --metric shape --bins 3,4,x,2,2,2
expect 1 "radius_bins is 0" "$reprise" similarity pair.reprise --metric shape --bins 0,4,8,2,2,2
expect 1 "voxel_size is 0" "$reprise" similarity pair.reprise --metric shape --voxel 0
expect 1 "voxels of 0.001 m: expected at most" "$reprise" similarity pair.reprise --metric shape --voxel 0.001
expect 1 "color_bins" "$reprise" similarity pair.reprise --metric shape-colour --bins 3,4,8,2,2,0
[ ! -e no.json ] || fail "a graph that failed left a file"
expect 0 "transitions" "$reprise" graph pair.reprise -o pair.json --remove 'walk->stand'
expect 0 "transitions" "$reprise" graph pair.reprise -o pair.json
expect 1 "no path" "$reprise" keyframes pair.reprise --graph pair.json --from walk:1 --to stand:9 --distance 1 --time 1 -o new.reprise
expect 1 "database" "$reprise" keyframes figure.reprise --graph pair.json --from walk:1 --to stand:9 -o new.reprise
keep pair.json
expect 1 "did you mean 'stand'" "$reprise" graph pair.reprise -o pair.json --remove 'walk->stnd'
expect 1 "does not fit" "$reprise" graph pair.reprise -o pair.json --add 'walk:0->stand:9'
expect 1 "is not protected" "$reprise" graph pair.reprise -o pair.json --unprotect 'walk->stand'
expect 2 "--prune" "$reprise" graph pair.reprise -o pair.json --prune all
unchanged pair.json
expect 0 "1 made by hand" "$reprise" graph pair.reprise -o pair.json --add 'walk:9->stand:9@4' --components
expect 0 "only lead in" "$reprise" graph pair.reprise -o pair.json --components
expect 0 "proved optimal" "$reprise" keyframes pair.reprise --graph pair.json --from walk:1 --to stand:14 --distance 1 --time 1 -o by_hand.reprise
head -c 200 graph.json > broken.json
expect 1 "broken.json" "$reprise" keyframes figure.reprise --graph broken.json --from walk:1 --to wave:2 -o new.reprise
unchanged new.reprise

# Output: unknown kinds, missing folders, foreign folders, a full disk
expect 1 "format" "$reprise" export new.reprise -o new.xyz
expect 1 "no folder" "$reprise" export new.reprise -o nowhere/new.glb
mkdir mine && echo "my thesis" > mine/thesis.txt
expect 1 "thesis.txt" "$reprise" export new.reprise -o mine --format obj
[ -f mine/thesis.txt ] || fail "export deleted a user's file"
keep figure.reprise
for target in "export figure.reprise --clip walk -o full.glb" "export figure.reprise --clip walk -o full.mdd" \
  "export figure.reprise --clip walk -o full --format ply" "perform --costume figure -o figure.reprise" \
  "model learn figure.reprise --count 3" \
  "import figure.reprise --sequence walk=walk"; do
  # A limit on the size of files is the nearest thing to a full disk that needs no rights.
  # shellcheck disable=SC2086
  (ulimit -f 20; trap '' XFSZ; "$reprise" $target > out.txt 2>&1)
  [ $? -eq 1 ] || fail "a full disk went unnoticed: $target"
done
unchanged figure.reprise
[ ! -e full.glb ] && [ ! -e full.mdd ] && [ ! -e full ] || fail "a full disk left half a file"
no_partial_files

# An output is never an input, nor two outputs one file
keep graph.json
keep figure.reprise
query=(keyframes figure.reprise --graph graph.json --from stand:5 --to wave:20 --time 6 --distance 6)
expect 1 "not written over" "$reprise" "${query[@]}" -o ./figure.reprise
expect 1 "not written over" "$reprise" "${query[@]}" -o new.reprise --report "$PWD/graph.json"
expect 1 ".json" "$reprise" "${query[@]}" -o new.reprise --report r.txt
expect 1 "no folder" "$reprise" "${query[@]}" -o new.reprise --report nowhere/r.json
expect 1 "not written over" "$reprise" similarity figure.reprise --picture figure.reprise
expect 1 ".svg" "$reprise" graph figure.reprise -o other.json --picture graph.png
expect 1 "not written over" "$reprise" export figure.reprise --clip walk -o figure.reprise --format glb
expect 1 "not written over" "$reprise" render figure.reprise --clip walk -o figure.reprise
unchanged graph.json
unchanged figure.reprise
unchanged new.reprise

# Standard error may be closed: the exit code still tells
"$reprise" info nowhere.reprise 2>&-
[ $? -eq 1 ] || fail "no exit code without standard error"

# Ctrl-C in the middle: an older result stays, nothing half-written is left
"$reprise" perform --costume figure -o big.reprise --voxel-size 0.008 > out.txt 2>&1 &
job=$!
sleep 1
kill -INT $job
wait $job
code=$?
[ $code -eq 130 ] || [ $code -eq 0 ] || fail "Ctrl-C ended with exit code $code, expected 130"
[ $code -eq 0 ] || [ ! -e big.reprise ] || fail "Ctrl-C left a database"
no_partial_files

[ $failures -eq 0 ] && echo "all checks passed"
exit $((failures > 0))
