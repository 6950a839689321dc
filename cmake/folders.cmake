# A file's folder decides what it is built into. rilievo/FOLDER/**.cpp goes into rilievo::core; what
# lies in a folder gl/ or opengl/, or in one of RILIEVO_GL_FOLDERS, goes into rilievo::rilievo;
# **_test.cpp goes into the program test_FOLDER or, if it needs OpenGL, test_FOLDER_gl.

# In the order in which they may include each other; tools/check_layers has the exact table.
set(RILIEVO_FOLDERS core measure gl io warp scene render capture kind nailboard layered_impostor
    environment_nodes layered_relief relief_impostor representation frame keyframes cache method web_walk
    serve compare)
set(RILIEVO_GL_FOLDERS gl compare)

set(RILIEVO_CORE_LINKS glm::glm Threads::Threads OpenEXR::OpenEXR TBB::tbb fmt::fmt draco::draco
    meshoptimizer::meshoptimizer JPEG::JPEG PNG::PNG embree PkgConfig::webp hwy SQLite::SQLite3
    ZLIB::ZLIB)
# Only headers, and none of them in ours: who uses the installed library does not need them.
set(RILIEVO_CORE_HEADERS nlohmann_json::nlohmann_json Boost::headers)

# rilievo_sources(OUT FOLDER WITH_GL): the folder's .cpp files that need OpenGL, or those that do not.
function(rilievo_sources out folder with_gl)
  file(GLOB_RECURSE found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/rilievo/${folder}/*.cpp)
  list(FILTER found EXCLUDE REGEX "_fuzz\\.cpp$")
  if(folder IN_LIST RILIEVO_GL_FOLDERS)
    if(NOT with_gl)
      set(found)
    endif()
  elseif(with_gl)
    list(FILTER found INCLUDE REGEX "/rilievo/.*/(gl|opengl)/")
  else()
    list(FILTER found EXCLUDE REGEX "/rilievo/.*/(gl|opengl)/")
  endif()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

# rilievo_library(NAME WITH_GL): the library rilievo::NAME.
function(rilievo_library name with_gl)
  if(name STREQUAL "rilievo")
    set(target rilievo)
  else()
    set(target rilievo_${name})
  endif()
  set(sources)
  foreach(folder ${RILIEVO_FOLDERS})
    rilievo_sources(found ${folder} ${with_gl})
    list(FILTER found EXCLUDE REGEX "_test\\.cpp$")
    list(APPEND sources ${found})
    # A new file changes the batches of its own folder alone. Highway compiles some files once for
    # each instruction set: each of them must be the file that is compiled. Beast takes so long
    # that an edit beside it should not compile it again.
    set(batched 0)
    foreach(source ${found})
      file(STRINGS ${source} several REGEX "foreach_target|boost/beast" LIMIT_COUNT 1)
      if(NOT several)
        math(EXPR batch "${batched} / ${CMAKE_UNITY_BUILD_BATCH_SIZE}")
        math(EXPR batched "${batched} + 1")
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${batch})
      endif()
    endforeach()
  endforeach()
  add_library(${target} STATIC ${sources})
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  add_library(rilievo::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:rilievo_flags>)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:${RILIEVO_CORE_HEADERS}>)
  if(with_gl)
    target_link_libraries(${target} PUBLIC rilievo_core PkgConfig::epoxy PRIVATE fmt::fmt)
  else()
    target_link_libraries(${target} PUBLIC glm::glm PRIVATE ${RILIEVO_CORE_LINKS})
  endif()
  rilievo_install(${target} ${name} ${with_gl})
endfunction()

function(rilievo_test_program name folder with_gl)
  rilievo_sources(tests ${folder} ${with_gl})
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
  if(NOT tests)
    return()
  endif()
  add_executable(${name} ${tests})
  target_link_libraries(${name} PRIVATE rilievo_flags GTest::gtest_main ${RILIEVO_CORE_LINKS}
                                        ${RILIEVO_CORE_HEADERS})
  if(with_gl)
    target_link_libraries(${name} PRIVATE rilievo::rilievo PkgConfig::epoxy)
  else()
    target_link_libraries(${name} PRIVATE rilievo::core)
  endif()
  gtest_discover_tests(${name} TEST_PREFIX "${folder}: " DISCOVERY_TIMEOUT 60
                       PROPERTIES TIMEOUT 900)
endfunction()

# Each TEST becomes a test of CTest.
function(rilievo_tests)
  include(GoogleTest)
  foreach(folder ${RILIEVO_FOLDERS})
    rilievo_test_program(test_${folder} ${folder} FALSE)
    if(RILIEVO_WITH_GL)
      rilievo_test_program(test_${folder}_gl ${folder} TRUE)
    endif()
  endforeach()
endfunction()
