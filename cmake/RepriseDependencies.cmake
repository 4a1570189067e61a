# Third-party libraries as imported targets. Used by this build and, installed, by `find_package(Reprise)`.
include(CMakeFindDependencyMacro)
if(NOT CMAKE_FIND_PACKAGE_NAME)
  # In this build: without this, find_dependency would go on in silence where something is missing.
  set(CMAKE_FIND_PACKAGE_NAME Reprise)
  set(Reprise_FIND_REQUIRED TRUE)
endif()
find_dependency(Threads)
find_dependency(Eigen3 3.4)
find_dependency(TBB)
find_dependency(fmt)
find_dependency(spdlog)
find_dependency(nlohmann_json)
find_dependency(tl-expected)
find_dependency(PkgConfig)

# By default the alignment of Eigen's matrices follows the instruction set. A library compiled for this processor and a
# program that is not would then allocate and free the same matrix in two ways.
target_compile_definitions(Eigen3::Eigen INTERFACE EIGEN_MAX_ALIGN_BYTES=64 EIGEN_MAX_STATIC_ALIGN_BYTES=16)

# Debian packages without a usable CMake package: pkg-config, or header and library by name.
function(reprise_pkg_target target module)
  if(NOT TARGET reprise::dep::${target})
    pkg_check_modules(dep_${target} REQUIRED IMPORTED_TARGET GLOBAL ${module})
    add_library(reprise::dep::${target} INTERFACE IMPORTED GLOBAL)
    target_link_libraries(reprise::dep::${target} INTERFACE PkgConfig::dep_${target})
  endif()
endfunction()

function(reprise_plain_target target header libraries)
  if(NOT TARGET reprise::dep::${target})
    find_path(dep_${target}_include ${header} REQUIRED PATH_SUFFIXES suitesparse)
    add_library(reprise::dep::${target} INTERFACE IMPORTED GLOBAL)
    target_include_directories(reprise::dep::${target} SYSTEM INTERFACE ${dep_${target}_include})
    foreach(library IN LISTS libraries)
      find_library(dep_${target}_${library} ${library} REQUIRED)
      target_link_libraries(reprise::dep::${target} INTERFACE ${dep_${target}_${library}})
    endforeach()
  endif()
endfunction()

reprise_pkg_target(hdf5 hdf5)
reprise_pkg_target(epoxy epoxy)
reprise_pkg_target(graphviz libgvc)
reprise_pkg_target(png libpng)
reprise_pkg_target(turbojpeg libturbojpeg)
reprise_plain_target(xxhash xxhash.h "xxhash")
reprise_plain_target(cholmod cholmod.h "cholmod")
reprise_plain_target(openvdb openvdb/openvdb.h "openvdb;tbb;Imath")
