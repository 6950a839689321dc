# What `cmake --install` puts where, so that find_package(rilievo) finds it again:
#   include/rilievo/FOLDER/*.h, lib/librilievo_core.a, lib/librilievo.a, lib/cmake/rilievo/
# One set of targets for each library: who asks for `core` alone never meets OpenGL.

set(RILIEVO_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/rilievo)

function(rilievo_install target name with_gl)
  install(TARGETS ${target} EXPORT rilievo-${name}-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT rilievo-${name}-targets NAMESPACE rilievo:: DESTINATION ${RILIEVO_CMAKE_DIR})
  foreach(folder ${RILIEVO_FOLDERS})
    file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/rilievo/${folder}/*.h
                                                ${PROJECT_SOURCE_DIR}/rilievo/${folder}/*.inl)
    if(folder IN_LIST RILIEVO_GL_FOLDERS)
      if(NOT with_gl)
        continue()
      endif()
    elseif(with_gl)
      list(FILTER headers INCLUDE REGEX "/rilievo/.*/(gl|opengl)/")
    else()
      list(FILTER headers EXCLUDE REGEX "/rilievo/.*/(gl|opengl)/")
    endif()
    list(FILTER headers EXCLUDE REGEX "_test_helpers\\.h$")
    # Behind load_scene.h and save_glb.h; they need the headers of what reads for it.
    list(FILTER headers EXCLUDE REGEX "/scene/gltf/")
    # What the readers and writers of OpenEXR share; it needs OpenEXR's headers.
    list(FILTER headers EXCLUDE REGEX "/io/(exr_header|exr_parts|deep_exr_parts)\\.h$")
    # It needs Highway's headers.
    list(FILTER headers EXCLUDE REGEX "/(render/shading/simd_numbers|nailboard/software/texel_span|relief_impostor/warp_texels)\\.inl$")
    # Behind builtin.h.
    list(FILTER headers EXCLUDE REGEX "/scene/builtin/(bridge|parts|traffic|masonry|mesh_builder)[^/]*\\.h$")
    foreach(header ${headers})
      cmake_path(RELATIVE_PATH header BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/rilievo OUTPUT_VARIABLE path)
      cmake_path(GET path PARENT_PATH place)
      install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/rilievo/${place})
    endforeach()
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
