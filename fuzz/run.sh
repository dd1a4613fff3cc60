#!/usr/bin/env bash
# Runs one fuzzer, or all of them one after another, on the installed stable compiler.
# usage: fuzz/run.sh TARGET|all [SECONDS]
#
# Coverage needs no nightly compiler: the instrumentation that cargo-fuzz switches on is made of
# stable flags as long as no sanitizer is asked for, and safe code has little use for one.
set -euo pipefail
cd "$(dirname "$0")"
seconds=${2:-900}
build=${CARGO_TARGET_DIR:-$PWD/../target/fuzz}
triple=$(rustc -vV | sed -n 's/^host: //p')
flags="--cfg fuzzing -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4"
flags="$flags -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table"
flags="$flags -Cllvm-args=-sanitizer-coverage-trace-compares -Ccodegen-units=1"
# A target triple of its own keeps the flags away from build scripts and macros.
RUSTFLAGS=$flags CARGO_TARGET_DIR=$build cargo build --release --target "$triple" ${JOBS:+-j "$JOBS"}

run() {
    local target=$1 seeds=seeds/$1
    [ "$target" != threemf ] || seeds=seeds/3mf
    mkdir -p "corpus/$target" artifacts
    "$build/$triple/release/$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=1024 -max_len=65536 \
        -malloc_limit_mb=512 -print_final_stats=1 -artifact_prefix="artifacts/$target-" \
        "corpus/$target" "$seeds" 2>&1 | tee "artifacts/$target.log" | grep -E '^stat::|ERROR|panicked|DONE' || true
}

if [ "$1" = all ]; then
    for target in fuzz_targets/*.rs; do run "$(basename "$target" .rs)"; done
else
    run "$1"
fi
