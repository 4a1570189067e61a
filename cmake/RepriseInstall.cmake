# Installs headers, libraries, the program and a CMake package: `find_package(Reprise)` then gives one target per folder
# (Reprise::core ...) and Reprise::reprise, which is all of them.
include(CMakePackageConfigHelpers)

get_property(modules GLOBAL PROPERTY REPRISE_MODULES)
add_library(reprise_all INTERFACE)
add_library(Reprise::reprise ALIAS reprise_all)
set_target_properties(reprise_all PROPERTIES EXPORT_NAME reprise)
target_link_libraries(reprise_all INTERFACE ${modules})

install(TARGETS ${modules} reprise_all EXPORT RepriseTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/reprise DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h" PATTERN "*_test*" EXCLUDE)

get_property(programs DIRECTORY ${PROJECT_SOURCE_DIR}/src/apps/cli PROPERTY BUILDSYSTEM_TARGETS)
foreach(program IN LISTS programs)
  get_target_property(type ${program} TYPE)
  if(type STREQUAL "EXECUTABLE" AND NOT program MATCHES "_test$")
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
endforeach()

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/Reprise)
install(EXPORT RepriseTargets NAMESPACE Reprise:: DESTINATION ${package_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/RepriseConfig.cmake.in ${PROJECT_BINARY_DIR}/RepriseConfig.cmake
  INSTALL_DESTINATION ${package_folder})
# Before version 1 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/RepriseConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/RepriseConfig.cmake ${PROJECT_BINARY_DIR}/RepriseConfigVersion.cmake
  ${CMAKE_CURRENT_LIST_DIR}/RepriseDependencies.cmake DESTINATION ${package_folder})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
