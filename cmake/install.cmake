# What `cmake --install` puts where, so that find_package(rilievo) finds it again:
#   include/rilievo/: the public headers (public_headers.cmake), lib/librilievo_core.a, lib/librilievo.a, lib/cmake/rilievo/
# One set of targets for each library: who asks for `core` alone never meets OpenGL.

include(${CMAKE_CURRENT_LIST_DIR}/public_headers.cmake)

set(RILIEVO_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/rilievo)

function(rilievo_install target name with_gl)
  install(TARGETS ${target} EXPORT rilievo-${name}-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT rilievo-${name}-targets NAMESPACE rilievo:: DESTINATION ${RILIEVO_CMAKE_DIR})
  rilievo_needed_headers(headers ${RILIEVO_PUBLIC_HEADERS})
  foreach(header ${headers})
    string(REGEX MATCH "^[^/]*" folder ${header})
    set(needs_gl FALSE)
    if(folder IN_LIST RILIEVO_GL_FOLDERS OR header MATCHES "/(gl|opengl)/")
      set(needs_gl TRUE)
    endif()
    if(needs_gl STREQUAL with_gl)
      cmake_path(GET header PARENT_PATH place)
      install(FILES ${PROJECT_SOURCE_DIR}/rilievo/${header}
              DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rilievo/${place})
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
