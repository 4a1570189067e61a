# One set of compile options for every target of this tree.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

add_library(reprise_compile_options INTERFACE)
target_compile_options(reprise_compile_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  # Options structs are made with designated initialisers that name only what differs from the default.
  -Wno-missing-field-initializers
  # Contraction to fused multiply-add would make results depend on the processor's instruction set.
  -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 reports false positives of these inside Eigen (its AVX-512 products among them) and nlohmann-json.
  target_compile_options(reprise_compile_options INTERFACE
    -Wno-restrict -Wno-uninitialized -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
endif()
if(REPRISE_WERROR)
  target_compile_options(reprise_compile_options INTERFACE -Werror)
endif()
if(REPRISE_NATIVE)
  target_compile_options(reprise_compile_options INTERFACE -march=native)
endif()
if(REPRISE_SANITIZE)
  target_compile_options(reprise_compile_options INTERFACE
    -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(reprise_compile_options INTERFACE -fsanitize=address,undefined)
endif()

find_program(REPRISE_CCACHE ccache)
if(REPRISE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER ${REPRISE_CCACHE})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${REPRISE_CCACHE})
endif()
find_program(REPRISE_MOLD mold)
if(REPRISE_MOLD)
  add_link_options(-fuse-ld=mold)
endif()
