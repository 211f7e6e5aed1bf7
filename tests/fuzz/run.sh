#!/bin/bash
# run.sh PROGRAM KEPT_INPUTS FINDS: runs a libFuzzer program from a copy of its kept inputs, so that the checkout stays as it is.
# Decoders run for FUZZ_RUNS inputs (200000), readers of matrix, scene and level files for FUZZ_SECONDS (3). A find is kept in FINDS.
set -euo pipefail
program=$1 kept=$2 finds=$3 name=$(basename "$1")
case $name in
  fuzz_codec_payload | fuzz_container) limits=-runs=${FUZZ_RUNS:-200000} ;;
  fuzz_delimiter) limits="-runs=${FUZZ_RUNS:-200000} -max_len=128" ;;  # sixteen of the decoder's windows, and many numbers
  *) limits=-max_total_time=${FUZZ_SECONDS:-3} ;;
esac
corpus=$(mktemp -d)
trap 'rm -rf "$corpus"' EXIT
mkdir -p "$finds"
cp "$kept"/* "$corpus"
rm -f "$corpus"/stalls-*  # 5 seconds each, and libFuzzer begins with every input thrice; the other builds rerun them
# HDF5 files are read for at most 5 CPU seconds, so 30 is a hang. Short stacks of allocations and little memory held back after it is
# freed take a fifth off the time; what a find needs to be understood, its rerun tells.
ASAN_OPTIONS=malloc_context_size=1:quarantine_size_mb=16 \
  "$program" $limits -rss_limit_mb=2048 -timeout=30 -artifact_prefix="$finds/$name-" "$corpus"
