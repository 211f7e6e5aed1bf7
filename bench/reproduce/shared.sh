# shellcheck shell=bash
# What the scripts of ./reproduce share: levels and matrices by name, and steps: a stopped run continues after the last finished one.
#
# A script sources this file, defines the function `steps`, which calls `step` once for each part of its result, and ends
# with `run_steps`. `steps` is called twice: first to list the steps, then to run them.
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
. .ci/setup.sh

result=$(basename "$0" .sh) full='' afresh=''
for argument in "$@"; do
  case $argument in
    --full) full=yes ;;
    --afresh) afresh=yes ;;
    *) say "reproduce: '$argument' is neither --full nor --afresh"; exit 1 ;;
  esac
done
vismat=build/release/vismat
bench=build/release/bench
levels=${VISMAT_CACHE:-cache/levels}
out=out/$result
work=$out/$([ -n "$full" ] && echo full || echo short) # a folder for each step, with what the step wrote

# ---- levels and matrices by name -----------------------------------------------------------------------------------------

declare -A place_of=(
  [oa_koth1]=openarena-081-maps/pak1-maps.pk3
  [ctf_inyard]=openarena-081-maps/pak1-maps.pk3
  [czest2ctf]=openarena-081-maps/pak1-maps.pk3
  [czest3ctf]=openarena-081-maps/pak1-maps.pk3
  [oa_spirit3]=openarena-081-maps/pak1-maps.pk3
  [oasago2]=openarena-081-maps/pak1-maps.pk3
  [aggressor]=openarena-081-maps/pak1-maps.pk3
  [wrackdm17]=openarena-081-maps/pak1-maps.pk3
  [am_underworks2]=openarena-085-data/pak6-patch085.pk3
  [ctf_compromise]=openarena-085-data/pak6-patch085.pk3
  [oa_thor]=openarena-088-data/pak6-patch088.pk3
  [oacmpdm4]=openarena-oacmp1/z_oacmp-volume1-v3.pk3
  [oacmpdm9]=openarena-oacmp1/z_oacmp-volume1-v3.pk3
  [E1M1]=freedoom/freedoom1.wad
  [E2M3]=freedoom/freedoom1.wad
  [MAP01]=freedoom/freedoom2.wad
  [MAP10]=freedoom/freedoom2.wad
  [MAP20]=freedoom/freedoom2.wad
)

# level NAME: where the level lies, as vismat reads it.
level() {
  local package=${place_of[$1]%/*} file=${place_of[$1]#*/}
  case $file in
    *.pk3) echo "$levels/$package/usr/share/games/openarena/baseoa/$file:maps/$1.bsp" ;;
    *.wad) echo "$levels/$package/usr/share/games/doom/$file:$1" ;;
  esac
}

# not_measured WHAT: says so once, here and on the report's page.
not_measured() {
  if grep -qxFs "$1" "$out/not_measured.txt"; then return; fi
  echo "$1" >>"$out/not_measured.txt"
  say "not measured: $1"
}

# present NAME...: prints those of these levels and matrices whose package was fetched, and says which are missing.
present() {
  local name level file
  for name in "$@"; do
    level=${name%%.*}
    if [[ -v place_of[$level] ]]; then
      file=$(level "$level")
      if [ ! -e "${file%%:*}" ]; then
        not_measured "$level: package ${place_of[$level]%/*} was not fetched"
        continue
      fi
    fi
    echo "$name"
  done
}

# every_level PACKAGE COMMAND...: runs COMMAND with each level of the package. Levels without visibility data are passed over.
every_level() {
  local package=$1 file place
  shift
  find "$levels/$package" -type f \( -name '*.pk3' -o -name '*.wad' \) | sort | while read -r file; do
    "$vismat" info "$file" | sed -n 's/^[0-9 ]* bytes  //p' | while read -r place; do
      "$@" "$place" </dev/null || say "passed over: $place"
    done
  done
}

# every_package: the names of the packages that were fetched.
every_package() { find "$levels" -mindepth 1 -maxdepth 1 -type d ! -name '.*' -printf '%f\n' | sort; }

# matrix NAME: the path of a matrix, which is made if it is missing or older than the program.
#   artificial-1, artificial-2   an artificial city, over the nodes of its quadtree
#   LEVEL.cells, LEVEL.faces     what the view cells of a level see of one another, or of its faces
#   LEVEL.cells.nodes ...        the same, over the nodes of a tree of boxes
#   LEVEL.octants, dense-city.octants, plant.octants   view cells against octants of a level or a generated scene
#   NAME.differences             the differences between cells that touch in matrix NAME
matrix() {
  local file=out/matrices/$1.bsp.h5 part=out/matrices/part/$1.bsp.h5 name=$1 tree=(none) kind
  mkdir -p out/matrices/part
  {
    flock 8 # another result may want the same matrix
    if [ ! "$file" -nt "$vismat" ]; then
      case $name in
        *.differences) "$vismat" deltas "$(matrix "${name%.differences}")" -o "$part" ;;
        artificial-*)
          "$vismat" city --size $((32 * ${name#artificial-})) -o "out/matrices/part/$name.scene.h5"
          "$vismat" see "out/matrices/part/$name.scene.h5" --producer climbing -o "$part"
          ;;
        *.octants)
          name=${name%.octants}
          if [[ -v place_of[$name] ]]; then name=$(level "$name"); fi
          "$bench" octants "$name" -o "$part"
          ;;
        *)
          if [[ $name == *.nodes ]]; then tree=(bounds --nodes); fi
          kind=${name#*.}
          "$vismat" import "$(level "${name%%.*}")" --matrix "${kind%.nodes}" --tree "${tree[@]}" -o "$part"
          ;;
      esac
      mv "$part" "$file"
    fi
  } 8>"out/matrices/part/$1.lock" >&2
  echo "$file"
}
make_matrix() { matrix "$1" >/dev/null; }

# ---- steps ---------------------------------------------------------------------------------------------------------------

titles=() slugs=() expected=() gigabytes=() finished=() # of all steps, in their order; expected are seconds
planning=yes number=0 left=0 beside=()

# step [--memory GB] [--beside] TITLE COMMAND...: a part of the result. COMMAND writes its files to the folder $part, which
# gets its final name when COMMAND has ended well, so that a file is there wholly or not at all. A step that the same command
# of the same program finished before is not run again. With --beside the next steps do not wait for this one.
step() {
  local memory=0 background='' title
  while [[ $1 == --* ]]; do
    case $1 in
      --memory) memory=$2; shift 2 ;;
      --beside) background=yes; shift ;;
    esac
  done
  title=$1
  shift
  if [ -n "$planning" ]; then plan_step "$title" "$memory" "$@"; else run_step "$background" "$@"; fi
}

plan_step() {
  local slug
  slug=$(tr -cs 'A-Za-z0-9._\n' - <<<"$1")
  titles+=("$1") slugs+=("$slug") gigabytes+=("$2")
  expected+=("$(awk -F, -v step="$1" '$1 == step { print int(60 * $2 + .5) }' "results/$result/steps.csv" 2>/dev/null || true)")
  if [ "$(cat "$work/$slug/.made-by" 2>/dev/null || true)" = "$(made_by "${@:3}")" ]; then finished+=(yes); else finished+=(''); fi
}

# What a step's files depend on: the programs, the command and, where that is a function, what it does.
made_by() {
  echo "$programs"
  printf '%q ' "$@"
  echo
  declare -f "$1"
}

run_step() {
  local i=$number background=$1 about='' free
  number=$((number + 1))
  if [ -n "${finished[i]}" ]; then return; fi
  if [ -n "$full" ] && [ -n "${expected[i]}" ]; then about=" (about $(clock "${expected[i]}"); $(clock $left) to go)"; fi
  printf '\n== %d of %d: %s%s\n' $number ${#titles[@]} "${titles[i]}" "$about"
  left=$((left - ${expected[i]:-0}))
  free=$(awk '/^MemAvailable/ { print int($2 / 1e6) }' /proc/meminfo)
  if [ "${gigabytes[i]}" -gt "$free" ]; then
    not_measured "${titles[i]}: it takes ${gigabytes[i]} GB of memory, and $free GB are free"
    return
  fi
  set -m # a process group of its own
  measure_step "$i" "${@:2}" &
  set +m
  if [ -n "$background" ]; then beside+=($!); else finish $!; fi
}

finish() { wait "$1" || { say 'reproduce: a step failed; what was finished before is kept, and the next run goes on from there'; exit 1; }; }

measure_step() {
  local title=${titles[$1]} folder=$work/${slugs[$1]} group=$BASHPID start=$SECONDS before other watch
  shift
  exec 9>&-
  set +m
  outlive_nobody "$group" &
  watch=$!
  part=$folder.part-$$
  mkdir -p "$part"
  before=$(busy_ticks)
  "$@"
  other=$(($(busy_ticks) - before - $(awk '{ print $14 + $15 + $16 + $17 }' /proc/$group/stat)))
  awk -v step="$title" -v seconds=$((SECONDS - start)) -v other=$other -v ticks="$(($(nproc) * $(getconf CLK_TCK)))" \
    -v more="$(date -u +%F),$(git describe --always --dirty 2>/dev/null || echo unknown)" \
    'BEGIN { share = seconds > 0 ? 100 * other / ticks / seconds : 0
             printf("%s,%.2f,%.0f,%s\n", step, seconds / 60, (share > 0) * share, more) }' >"$part/.step"
  made_by "$@" >"$part/.made-by"
  rm -rf "$folder"
  mv "$part" "$folder"
  kill $watch
}

# outlive_nobody GROUP: ends a step when this script has ended, however that came: the step then has another parent.
outlive_nobody() {
  local parent=$$
  while [ "$parent" = $$ ]; do
    sleep .5
    read -r _ _ _ parent _ <"/proc/$1/stat" || return 0
  done
  kill -- "-$1"
}

# Processor time, in ticks, that all programs of this machine have taken.
busy_ticks() { awk '/^cpu / { print $2 + $3 + $4 + $7 + $8 }' /proc/stat; }

# list_steps: what the long form is going to do, and how long it takes.
list_steps() {
  local i time more total=0 unknown=0 where
  printf '\n%s --full: %d steps\n' "$result" ${#titles[@]}
  for i in "${!titles[@]}"; do
    time='not known' more=''
    if [ -n "${expected[i]}" ]; then time=$(clock "${expected[i]}"); elif [ -z "${finished[i]}" ]; then unknown=$((unknown + 1)); fi
    if [ "${gigabytes[i]}" != 0 ]; then more=", ${gigabytes[i]} GB of memory"; fi
    if [ -n "${finished[i]}" ]; then more+=', finished before'; fi
    printf '  %12s  %s\n' "$time" "${titles[i]}$more"
    total=$((total + ${expected[i]:-0}))
  done
  where=$(sed -n 's/^# machine: //p' "results/$result/steps.csv" 2>/dev/null || true)
  printf '  %12s  altogether%s\n' "$(clock $total)" "${where:+, as measured on: $where}"
  if [ $unknown -gt 0 ]; then more=", and $unknown steps whose time is not known"; else more=''; fi
  printf '  %12s  to go%s\n' "$(clock $left)" "$more"
}

# gather: puts together in $out what the steps left, in their order: tables under one header, texts one after another.
gather() {
  local slug file
  find "$out" -mindepth 1 -maxdepth 1 ! -name full ! -name short ! -name not_measured.txt ! -name '.*' -exec rm -rf {} +
  echo 'step,minutes,other_work_percent,date,commit' >"$out/steps.csv"
  for slug in "${slugs[@]}"; do
    [ -d "$work/$slug" ] || continue
    cat "$work/$slug/.step" >>"$out/steps.csv"
    (cd "$work/$slug" && find . -type f ! -name '.*' -printf '%P\n' | sort) | while read -r file; do
      mkdir -p "$(dirname "$out/$file")"
      case $file in
        *.csv)
          [ -e "$out/$file" ] || head -n 1 "$work/$slug/$file" >"$out/$file"
          tail -n +2 "$work/$slug/$file" >>"$out/$file"
          ;;
        *.txt) cat "$work/$slug/$file" >>"$out/$file" ;;
        *) cp "$work/$slug/$file" "$out/$file" ;;
      esac
    done
  done
}

# run_steps PACKAGE...: fetches these packages of levels (all of them if none is named), runs the steps and makes the page.
run_steps() {
  local i skipped=0 process status=0
  install_packages
  build release vismat bench
  ./fetch-levels "$levels" "$@" || status=$?
  if [ $status = 3 ]; then say 'going on with the artificial scenes and what was fetched before'; elif [ $status != 0 ]; then exit 1; fi
  programs=$(sha256sum $vismat $bench)

  mkdir -p "$work"
  exec 9>"$out/.lock"
  flock -n 9 || { say "reproduce: another run is making $result"; exit 1; }
  rm -rf "$out/not_measured.txt" "$work"/*.part-*
  if [ -n "$afresh" ]; then rm -rf "$work"; fi
  steps
  for i in "${!titles[@]}"; do
    if [ -n "${finished[i]}" ]; then skipped=$((skipped + 1)); else left=$((left + ${expected[i]:-0})); fi
  done
  if [ -n "$full" ]; then list_steps; fi
  if [ $skipped -gt 0 ]; then say "$skipped of ${#titles[@]} steps were finished before by the same program; --afresh runs them again"; fi
  planning=''
  steps
  for process in "${beside[@]}"; do finish "$process"; done

  gather
  if [ ! -e "bench/reproduce/${result}_report.py" ]; then return; fi
  printf '\n== the page, %s/report.html\n' "$out"
  /usr/bin/python3 "bench/reproduce/${result}_report.py" out ${full:+"results/$result"}
}
