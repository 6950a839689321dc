# Text files that the library carries within itself.

# rilievo_embed(TARGET FOLDER): every file NAME of the folder becomes FOLDER/NAME.inc on TARGET's
# include path, one raw string literal, made anew when NAME changes.
function(rilievo_embed target folder)
  file(GLOB files CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*)
  foreach(file ${files})
    file(READ ${file} text)
    cmake_path(GET file FILENAME name)
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/generated/${folder}/${name}.inc
         CONTENT "R\"embedded(@text@)embedded\"\n" @ONLY)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  endforeach()
  target_include_directories(${target} PRIVATE ${PROJECT_BINARY_DIR}/generated)
endfunction()
