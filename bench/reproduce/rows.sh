#!/bin/bash
# rows        every row codec and its rivals on levels, octants, differences, sectors and artificial scenes: bytes against zpaq, speed, and goals
. "$(dirname "$0")/shared.sh"

# compare MATRIX...: bytes of zpaq in the natural order, to which all others are compared, and every codec in the best order. Each
# payload is decoded and compared with the matrix.
compare() {
  "$vismat" compare --orders natural --codecs zpaq --seconds 0 --csv "$part/natural.csv" "$@"
  "$vismat" compare --orders best --seconds .1 --csv "$part/best.csv" "$@"
}

# in_folder COMMAND...: runs it with a folder for its matrices as last argument, which is removed afterwards.
in_folder() {
  mkdir "$part/matrices"
  "$@" "$part/matrices"
  rm -r "$part/matrices"
}

# measure_level NAME PLACE FOLDER: the families of matrices that a level has.
measure_level() {
  local of=$3/$1
  if ! "$vismat" import "$2" --matrix cells --tree none -o "$of.cells.bsp.h5"; then
    not_measured "$1: it cannot be imported"
    return
  fi
  case $2 in
    *.wad:*) mv "$of.cells.bsp.h5" "$of.sectors.bsp.h5" ;;
    *)
      "$vismat" deltas "$of.cells.bsp.h5" -o "$of.deltas.bsp.h5"
      "$vismat" import "$2" --matrix faces --tree none -o "$of.faces.bsp.h5"
      "$bench" octants "$2" -o "$of.octants.bsp.h5" || not_measured "$1.octants: no octants or no view cells"
      ;;
  esac
  compare "$of".*.bsp.h5
}
level_of() { in_folder measure_level "$1" "$2"; }

measure_octants() {
  "$bench" octants "$1" -o "$2/$1.octants.bsp.h5"
  compare "$2/$1.octants.bsp.h5"
}
octants_of() { in_folder measure_octants "$1"; }

# measure_see NAME SIZE FOLDER: what 'vismat see' lists of a generated scene's objects.
measure_see() {
  "$vismat" "$1" --size "$2" -o "$3/$1.scene.h5"
  "$vismat" see "$3/$1.scene.h5" -o "$3/$1.see.bsp.h5"
  compare "$3/$1.see.bsp.h5"
}
see_of() { in_folder measure_see "$1" "$2"; }

artificial() {
  local file
  file=$(matrix "$1")
  compare "$file"
}

# speed MATRIX: single rows as numbers and as bits.
speed() {
  local file
  file=$(matrix "$1")
  "$vismat" order "$file" --columns best --rows best -o "$part/ordered.bsp.h5"
  "$bench" row-speed "$part/ordered.bsp.h5" --benchmark_filter='/(ids|bits)/warm' --benchmark_repetitions=5 --benchmark_min_time=.05 \
    --benchmark_format=csv | awk -F, -v matrix="$1" \
    'BEGIN { print "matrix,codec,form,row_us,gb_s,ids_s" }
     /_median"/ { gsub(/"/, "", $1); sub(/\/warm.*/, "", $1); split($1, name, "/"); print matrix "," name[1] "," name[2] "," $4 / 1e3 "," $6 / 1e9 "," $7 }' \
    >"$part/speed.csv"
  rm "$part/ordered.bsp.h5"
}

# small_level FOLDER: the matrices that the studies take, of a level of 762 clusters and one of 435 sectors.
small_level() {
  local place kind
  place=$(level oa_spirit3)
  for kind in cells faces; do "$vismat" import "$place" --matrix $kind --tree none -o "$1/oa_spirit3.$kind.bsp.h5"; done
  "$vismat" deltas "$1/oa_spirit3.cells.bsp.h5" -o "$1/oa_spirit3.deltas.bsp.h5"
  "$bench" octants "$place" --octants 1000 --view-cells 800 -o "$1/oa_spirit3.octants.bsp.h5"
  "$vismat" import "$(level MAP10)" --matrix cells --tree none -o "$1/MAP10.sectors.bsp.h5"
}

# study FOLDER: what each part of rows-small and rows-quick buys, what the bits are, wrong orders and wrong entries; and what they
# take if they are trained on these matrices without one of the contexts.
study() {
  local idea
  small_level "$1"
  "$bench" row-study "$1"/*.bsp.h5 --out "$part"
  echo 'matrix,without,small,quick' >"$part/training.csv"
  for idea in '' shape recent left; do
    "$bench" train-rows --rounds 2 ${idea:+--without $idea} "$1"/*.bsp.h5 |
      awk -v idea="${idea:-nothing}" 'NR > 1 { print $1 "," idea "," $5 "," $6 }' >>"$part/training.csv"
  done
}

# one_level PACKAGE PLACE: a step for a level of a package. Levels of one name may be in several.
one_level() {
  local file=${2%%:*} name=${2##*:}
  name=$(basename "$name" .bsp)@$(basename "${file%.*}")
  step "level $name of $1" level_of "$name" "$2"
}

steps() {
  local name package place
  if [ -n "$full" ]; then
    for package in $(every_package); do
      while read -r place; do one_level "$package" "$place"; done < <(every_level "$package" echo)
    done
  else
    for name in $(present E1M1 MAP10 oa_spirit3 oa_koth1); do step "level $name" level_of "$name" "$(level "$name")"; done
  fi
  for name in dense-city plant; do step "octants of $name" octants_of "$name"; done
  step 'objects of dense-city by see' see_of dense-city "$([ -n "$full" ] && echo 20 || echo 8)"
  step 'objects of plant by see' see_of plant "$([ -n "$full" ] && echo 3 || echo 2)"
  for name in artificial-1 ${full:+artificial-2}; do
    step "view cells of $name" make_matrix "$name"
    step "every codec: $name" artificial "$name"
  done
  if [ "$(present oa_spirit3 MAP10 | wc -l)" = 2 ]; then step 'study of rows-small and rows-quick' in_folder study; fi
  for name in $(present oa_koth1.cells oa_koth1.faces); do step "speed of single rows: $name" speed "$name"; done
}

if [ -n "$full" ]; then run_steps; else run_steps openarena-081-maps freedoom; fi
