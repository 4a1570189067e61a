# cmake -DWORK=FOLDER -P include_check_test.cmake
#
# Tests the include check: a tree without fault passes; each fault alone makes it fail and is named with file and line.
cmake_minimum_required(VERSION 3.25)

set(spdx "// SPDX-FileCopyrightText: 2026 The Reprise authors\n// SPDX-License-Identifier: Apache-2.0\n")

function(make_tree)
  file(REMOVE_RECURSE ${WORK})
  file(WRITE ${WORK}/src/reprise/core/error.h "${spdx}\n#pragma once\n")
  file(WRITE ${WORK}/src/reprise/mesh/mesh.h "${spdx}\n#pragma once\n\n#include \"reprise/core/error.h\"\n")
  file(WRITE ${WORK}/src/reprise/mesh/mesh_test.cpp
    "${spdx}\n#include \"reprise/mesh/mesh.h\"\n#include \"support/shapes.h\"\n")
  file(WRITE ${WORK}/src/apps/cli/command.h "${spdx}\n#pragma once\n")
  file(WRITE ${WORK}/src/apps/cli/main.cpp "${spdx}\n#include \"command.h\"\n#include \"reprise/mesh/mesh.h\"\n")
endfunction()

function(run_check result_out output_out)
  execute_process(COMMAND ${CMAKE_COMMAND} -DROOT=${WORK} -P ${CMAKE_CURRENT_LIST_DIR}/include_check.cmake
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(${result_out} ${result} PARENT_SCOPE)
  set(${output_out} "${output}" PARENT_SCOPE)
endfunction()

function(expect_violation file text message)
  make_tree()
  file(WRITE ${WORK}/${file} "${text}")
  run_check(result output)
  string(FIND "${output}" "${message}" position)
  if(result EQUAL 0 OR position EQUAL -1)
    message(SEND_ERROR "${file}: expected a failure that says\n  ${message}\nfound result ${result} and\n${output}")
  endif()
endfunction()

make_tree()
run_check(result output)
if(NOT result EQUAL 0)
  message(SEND_ERROR "a tree without fault failed:\n${output}")
endif()

# A folder includes from one below it.
expect_violation(src/reprise/core/log.cpp "${spdx}\n#include \"reprise/core/error.h\"\n#include \"reprise/mesh/mesh.h\"\n"
  "src/reprise/core/log.cpp:5: includes \"reprise/mesh/mesh.h\": core stands above mesh")
# An indented include is one, too.
expect_violation(src/reprise/core/log.cpp "${spdx}  # include \"reprise/mesh/mesh.h\"\n"
  "src/reprise/core/log.cpp:3: includes \"reprise/mesh/mesh.h\": core stands above mesh")
# A folder that the order does not know, as the place of a file and of an include.
expect_violation(src/reprise/misc/a.cpp "${spdx}" "src/reprise/misc/a.cpp:1: the folder misc is not in the order")
expect_violation(src/reprise/mesh/a.cpp "${spdx}#include \"reprise/misc/a.h\"\n"
  "src/reprise/mesh/a.cpp:3: includes \"reprise/misc/a.h\": the folder misc is not in the order")
# The library includes a program's file, a path that is not from the root, and the test support outside of a test.
expect_violation(src/reprise/mesh/a.cpp "${spdx}#include \"command.h\"\n" "a.cpp:3: includes \"command.h\": expected")
expect_violation(src/reprise/mesh/a.cpp "${spdx}#include \"mesh.h\"\n" "a.cpp:3: includes \"mesh.h\": expected")
expect_violation(src/reprise/mesh/a.cpp "${spdx}#include \"support/shapes.h\"\n"
  "a.cpp:3: includes \"support/shapes.h\": expected")
# A program includes what is not its own.
expect_violation(src/apps/cli/a.cpp "${spdx}#include \"support/shapes.h\"\n"
  "a.cpp:3: includes \"support/shapes.h\": expected")
# A header without guard.
expect_violation(src/reprise/mesh/a.h "${spdx}\n#include <vector>\n" "src/reprise/mesh/a.h:1: a header needs #pragma once")
# SPDX lines: none, in an empty file; the second missing; not at the top.
expect_violation(src/reprise/mesh/a.cpp "" "src/reprise/mesh/a.cpp:1: expected \"// SPDX-FileCopyrightText")
expect_violation(tests/a.cpp "// SPDX-FileCopyrightText: 2026 The Reprise authors\n" "tests/a.cpp:2: expected \"// SPDX-License")
expect_violation(examples/a.cpp "// An example.\n${spdx}" "examples/a.cpp:1: expected \"// SPDX-FileCopyrightText")
# Nothing to check is no success.
file(REMOVE_RECURSE ${WORK})
run_check(result output)
if(result EQUAL 0)
  message(SEND_ERROR "a missing tree passed:\n${output}")
endif()
