# cmake -DBUILD=BUILD_FOLDER -DWORK=FOLDER -DBUILD_TYPE=TYPE -DCXX=COMPILER -P install_and_consume.cmake
#
# Installs the built tree into an empty prefix below WORK, then configures, builds and runs the consumer beside this
# script with nothing but that prefix.
cmake_minimum_required(VERSION 3.25)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nfailed: ${result}\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
# Another place than the one it was installed to: a package must not know where it lay.
file(RENAME ${WORK}/prefix ${WORK}/moved_prefix)

file(GLOB_RECURSE package_files ${WORK}/moved_prefix/lib*/cmake/Reprise/*.cmake)
if(NOT package_files)
  message(FATAL_ERROR "no CMake package was installed")
endif()
foreach(file IN LISTS package_files)
  file(STRINGS ${file} leaks REGEX "${BUILD}")
  if(leaks)
    message(FATAL_ERROR "${file} names the build folder:\n${leaks}")
  endif()
endforeach()
file(GLOB_RECURSE tests ${WORK}/moved_prefix/*_test* ${WORK}/moved_prefix/include/*.cpp)
if(tests)
  message(FATAL_ERROR "tests or sources were installed: ${tests}")
endif()

run(${CMAKE_COMMAND} -G Ninja -S ${CMAKE_CURRENT_LIST_DIR} -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/moved_prefix
  -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_FLAGS=${CXX_FLAGS})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer)
