#!/bin/bash
# walks       a camera goes through scenes under run-time systems: what is read, drawn and late; Chhugani et al. 2005, sections 7 and 8
. "$(dirname "$0")/shared.sh"

# walk SCENE PATH VARIED VALUE OPTION...: a line of the table of walks. VALUE is that of what is varied, such as the cache's bytes.
walk() {
  local name=$1 path=$2 varied=$3 value=$4
  shift 4
  "$vismat" walk "$work_of/$name.bake" "$work_of/$name.$path" --summary "$part/one.json" "$@" || return 1
  /usr/bin/python3 bench/reproduce/walk_line.py "$part/one.json" "scene=$name" "path=$path" "varied=$varied" "value=$value" >>"$part/walks.csv"
  rm "$part/one.json"
}

# go SCENE FRAMES IMAGES [SIZE]: bakes the scene and walks through it.
go() {
  local name=$1 frames=$2 images=$3 size=${4:-} path system disk cache speed
  work_of=$part/scenes
  mkdir "$work_of"
  case $name in
    dense-city | plant) "$vismat" "$name" ${size:+--size "$size"} -o "$work_of/$name.scene.h5" ;;
    city) "$vismat" city --size "$size" -o "$work_of/city.scene.h5" ;;
  esac
  "$vismat" bake "$work_of/$name.scene.h5" -o "$work_of/$name.bake" | tee "$part/bake.txt"
  awk -v scene="$name" 'NR == 1 { print "scene,part,seconds,bytes" } NR > 1 { part = $1; i = 2
       while ($i !~ /^[0-9.]+$/) { part = part " " $i; ++i }
       bytes = ""; for (j = i + 1; j <= NF; ++j) bytes = bytes $j; print scene "," part "," $i "," bytes }' "$part/bake.txt" >"$part/bake.csv"
  rm "$part/bake.txt"
  /usr/bin/python3 bench/reproduce/walk_line.py --header >"$part/walks.csv"
  for path in walk turning to-and-fro teleport; do
    "$vismat" path "$work_of/$name.scene.h5" --kind "$path" --seconds 60 --speed 4 -o "$work_of/$name.$path" >/dev/null
  done
  for path in walk turning to-and-fro teleport; do
    for system in everything frustum frustum-levels cell-lists vlod; do
      walk "$name" "$path" system "$system" --system "$system" --frames "$frames" --images "$images"
    done
  done
  for disk in disk-2004 sata-ssd nvme network; do
    for system in vlod cell-lists frustum-levels; do
      for prefetch in 0 1; do walk "$name" walk disk "$prefetch" --system $system --disk $disk --prefetch $prefetch --frames "$frames"; done
    done
  done
  for cache in 64 128 256 512 1024 2048 4096 8192; do # kilobytes
    for prefetch in 0 1; do
      walk "$name" walk cache $cache --cache ${cache}K --prefetch $prefetch --frames "$frames" ||
        not_measured "$name: a cache of $cache kB, in which the largest chunk does not fit"
    done
  done
  for speed in 1 2 4 8 16 32; do # m/s; cells are some metres wide
    "$vismat" path "$work_of/$name.scene.h5" --kind walk --seconds 60 --speed $speed -o "$work_of/$name.speed" >/dev/null
    for prefetch in 0 1; do walk "$name" speed speed $speed --prefetch $prefetch --frames "$frames"; done
  done
  for system in everything frustum frustum-levels vlod; do
    "$vismat" walk "$work_of/$name.bake" "$work_of/$name.walk" --system $system --frames "$frames" --log "$part/one.csv" >/dev/null
    awk -F, -v scene="$name" -v system_name=$system 'NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; if (system_name == "everything") print "scene,system,t,triangles" }
         NR > 1 { print scene "," system_name "," $at["t"] "," $at["drawn_triangles"] }' "$part/one.csv" >>"$part/along.csv"
    rm "$part/one.csv"
  done
  rm -r "$work_of"
}

steps() {
  local frames=1000 images=50 city=6 dense=8 plant=1
  if [ -n "$full" ]; then frames=4000 images=20 city=16 dense=20 plant=2; fi
  step "the box city" go city $frames $images $city
  step "the dense city" go dense-city $frames $images $dense
  step "the plant" go plant $frames $images $plant
}

run_steps freedoom
