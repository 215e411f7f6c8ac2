#!/usr/bin/env bash
# Everything that has to hold, from a fresh Debian 12: installs, builds, tests. Exits non-zero when any step fails, and says which.
#
#   deploy/test.sh                 all steps
#   deploy/test.sh web browser     only these
#   deploy/test.sh threads service_threads   the long thread sanitizer runs, which are not among them
set -euo pipefail
cd "$(dirname "$0")/.."
source deploy/install.sh

export UBSAN_OPTIONS=${UBSAN_OPTIONS:-print_stacktrace=1}
export CTEST_OUTPUT_ON_FAILURE=1
jobs=$(nproc)
failed_tests=build/failed_tests.txt

# All tests of a preset, one more at once than there are cores: the longest mostly wait. The names of those that fail are kept for the
# summary, since their output is thousands of lines above it. The ten slowest are printed: they are what to cut first.
tests_of() {
  local logs=build/$1/Testing/Temporary times=$PWD/build/$1/test_times passed=true
  rm -rf "$failed_tests" "$times"
  ctest --preset "$1" -j "$((jobs + 1))" --no-tests=error || passed=false
  tests/slowest_tests.py "$times"
  $passed || {
    { sed -n 's/^[0-9]*://p' "$logs/LastTestsFailed.log"
      sed -n 's/^\[  FAILED  \] \([A-Za-z/]*\.[A-Za-z0-9_/]*\).*/\1/p' "$logs/LastTest.log" | sort -u; } | tr '\n' ' ' >"$failed_tests"
    return 1
  }
}

# The layout of C++ is .clang-format's, whatever the editor. What is written twice is one function: no ten lines are the same.
step_style() {
  find core proto server shaders tests \( -name '*.cpp' -o -name '*.h' \) -print0 | xargs -0 clang-format-14 --dry-run -Werror
  web/node_modules/.bin/jscpd --min-lines 10 --min-tokens 50 --exit-code 1 --fail-on-empty --reporters console-full \
    --format cpp,glsl,typescript,javascript,python --formats-exts 'cpp:cpp,h;glsl:comp,glsl' --ignore '**/gen/**' \
    core proto server shaders web/src tests
}

step_web() {
  npm --prefix web run --silent lint
  npm --prefix web run --silent build
  npm --prefix web test --silent
}

step_release() {
  cmake --preset release
  cmake --build --preset release
}

step_release_tests() { tests_of release; }

# The installed library, used by programs that know nothing of this folder.
step_library() {
  local result=build/examples/result
  rm -rf build/installed "$result"
  cmake --install build/release --prefix build/installed >/dev/null
  cmake -S core/examples -B build/examples -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$PWD/build/installed" >/dev/null
  cmake --build build/examples -j "$jobs"
  mkdir -p "$result"
  build/examples/reconstruct_recording synthetic:frames=4,width=160,height=120 "$result" >/dev/null
  build/examples/mesh_of_result "$result" "$result/mesh.stl"
  build/examples/own_camera
}

# The Debian packages: lintian, what is in them, and that building them again, by somebody with other habits, gives the same bytes.
# gzip takes a quarter of the time that xz takes. deploy/try_packages.sh installs them, too, and needs the network.
step_packages() {
  export PACKAGES_COMPRESSION=gzip
  deploy/packages.sh build/test-packages
  (umask 077 && TZ=Asia/Tokyo LC_ALL=C PACKAGES_LINTIAN=off deploy/packages.sh build/test-packages/again)
  tests/packages/check.py build/test-packages build/test-packages/again
}

# Another Vulkan driver than Mesa's, one that lacks much of what that has: SwiftShader, which lies beside Debian's chromium.
second_driver_filter='-*Death*'  # those start again and again, and tell nothing of a driver
step_second_driver() {
  local swiftshader=/usr/lib/chromium/vk_swiftshader_icd.json lavapipe
  lavapipe=$(find /usr/share/vulkan/icd.d -name 'lvp_icd*.json' 2>/dev/null | head -n 1)
  if [ ! -f "$swiftshader" ] || [ -z "$lavapipe" ]; then
    echo "SKIPPED: no SwiftShader at $swiftshader, or no lavapipe in /usr/share/vulkan/icd.d"
    return 0
  fi
  cmake --preset release >/dev/null
  cmake --build --preset release --target hermite test_gpu
  VK_ICD_FILENAMES=$swiftshader VK_DRIVER_FILES=$swiftshader build/release/tests/test_gpu --gtest_brief=1 --gtest_filter="$second_driver_filter"
  VK_ICD_FILENAMES=$lavapipe VK_DRIVER_FILES=$lavapipe HERMITE_GPU_WITHOUT=push-descriptors,texel-buffers,64-bit-atomics \
    build/release/tests/test_gpu --gtest_brief=1 --gtest_filter="$second_driver_filter"
  tests/drivers/second_driver.py build/release/server/hermite "$lavapipe" "$swiftshader"
}

# What a machine with a GPU and little else builds.
step_gpu_only() {
  cmake --preset gpu-only
  cmake --build --preset gpu-only
}

step_sanitized() {
  cmake --preset dev
  cmake --build --preset dev
}

step_sanitized_tests() { tests_of dev; }

# What hands work to a helper thread, under the thread sanitizer. Not among all steps, since it builds all of core once more: run it, and the
# next one, after a change of anything that threads share.
step_threads() {
  cmake --preset threads
  cmake --build --preset threads --target test_adjust test_calibrate
  build/threads/tests/test_adjust --gtest_brief=1 \
    --gtest_filter='Adjuster*:SubmapMapping.TheSame*:SubmapMapping.ALost*:SubmapMapping.ANewPart*'
  build/threads/tests/test_calibrate --gtest_brief=1 --gtest_filter='CameraWatch.Answers*:CameraWatch.Refuses*:Calibrate.IsTheSame*'
}

# The same for the service: frame log, queues, encoder, uploads, viewers, sockets, sessions and scans. Without what reconstructs most: a software
# GPU is too slow there, and not ours. It builds for ten minutes and tests for six.
step_service_threads() {
  cmake --preset threads
  cmake --build --preset threads --target test_data test_server
  build/threads/tests/test_data --gtest_brief=1 --gtest_filter='FrameLog*'
  TSAN_OPTIONS="suppressions=$PWD/tests/tsan_suppressions.txt" build/threads/tests/test_server --gtest_brief=1 \
    --gtest_filter='-*DeathTest*:SlowLogs*:ScanJob*:SqliteDatabase*:Service.*:Stream.*:HttpTest*:*LocalExecutor*:Local/*'
}

step_fuzz() { tests/fuzz/run; }

step_browser() {
  local results=$PWD/build/browser_tests.tap
  rm -f "$failed_tests"
  npm --prefix web run --silent test:browser -- --test-reporter=spec --test-reporter-destination=stdout --test-reporter=tap \
    --test-reporter-destination="$results" || {
    sed -n 's/^ *not ok [0-9]* - \(.*\)/\1;/p' "$results" | tr '\n' ' ' >"$failed_tests"
    return 1
  }
}

step_demo() {
  rm -rf build/test-demo
  DEMO_EXIT=1 DEMO_DATA=build/test-demo DEMO_SEQUENCE=synthetic:frames=10,width=320,height=240 deploy/demo.sh
}

run_steps() {
  local step started passed=0 failed=0 summary=""
  for step in "$@"; do
    printf '\n=== %s\n' "$step"
    started=$SECONDS
    # In a process of its own: a function that is asked "if" would go on after a failing command.
    if HERMITE_TEST_STEP=$step deploy/test.sh; then
      passed=$((passed + 1))
      summary+=$(printf '\n  ok      %-16s %4d s' "$step" $((SECONDS - started)))
    else
      failed=$((failed + 1))
      summary+=$(printf '\n  FAILED  %-16s %4d s  %s' "$step" $((SECONDS - started)) "$(cat "$failed_tests" 2>/dev/null || true)")
      rm -f "$failed_tests"
    fi
  done
  printf '\n=== summary%s\n\n%d passed, %d failed\n' "$summary" "$passed" "$failed"
  [ "$failed" -eq 0 ]
}

if [ -n "${HERMITE_TEST_STEP:-}" ]; then
  "step_$HERMITE_TEST_STEP"
  exit
fi
install_packages
provide_node
install_viewer
steps=("$@")
[ $# -gt 0 ] || steps=(style web release release_tests library packages second_driver gpu_only browser demo fuzz sanitized sanitized_tests)
run_steps "${steps[@]}"
