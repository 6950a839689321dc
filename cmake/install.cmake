# What `cmake --install` puts where, so that find_package(rilievo) finds it again:
#   include/rilievo/STAGE/*.h, lib/librilievo_core.a, lib/librilievo.a, lib/cmake/rilievo/
# One set of targets for each library: who asks for `core` alone never meets OpenGL.

set(RILIEVO_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/rilievo)

function(rilievo_install target name)
  cmake_parse_arguments(arg "" "" "STAGES" ${ARGN})
  install(TARGETS ${target} EXPORT rilievo-${name}-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT rilievo-${name}-targets NAMESPACE rilievo:: DESTINATION ${RILIEVO_CMAKE_DIR})
  foreach(stage ${arg_STAGES})
    if(EXISTS ${PROJECT_SOURCE_DIR}/rilievo/${stage})
      install(DIRECTORY ${PROJECT_SOURCE_DIR}/rilievo/${stage}
              DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rilievo FILES_MATCHING PATTERN "*.h"
              PATTERN "*_test_helpers.h" EXCLUDE
              # Behind load_scene.h; they need the headers of what reads for it.
              PATTERN "gltf_*.h" EXCLUDE
              # Behind save_glb.h and builtin.h.
              PATTERN "glb_*.h" EXCLUDE PATTERN "builtin_*.h" EXCLUDE
              PATTERN "masonry.h" EXCLUDE PATTERN "mesh_builder.h" EXCLUDE)
    endif()
  endforeach()
endfunction()

include(CMakePackageConfigHelpers)
configure_package_config_file(cmake/rilievo-config.cmake.in rilievo-config.cmake
                              INSTALL_DESTINATION ${RILIEVO_CMAKE_DIR})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(rilievo-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/rilievo-config.cmake
              ${PROJECT_BINARY_DIR}/rilievo-config-version.cmake
        DESTINATION ${RILIEVO_CMAKE_DIR})
