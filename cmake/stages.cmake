# A file's folder decides what it is built into: rilievo/STAGE/*.cpp goes into the stage's library,
# rilievo/STAGE/*_test.cpp into the program test_STAGE.

set(RILIEVO_CORE_LINKS glm::glm Threads::Threads OpenEXR::OpenEXR TBB::tbb fmt::fmt draco::draco
    meshoptimizer::meshoptimizer JPEG::JPEG embree PkgConfig::webp hwy)
# Only headers, and none of them in ours: who uses the installed library does not need them.
set(RILIEVO_CORE_HEADERS nlohmann_json::nlohmann_json)

# rilievo_library(NAME STAGES ...): the library rilievo::NAME out of the stages' folders.
function(rilievo_library name)
  cmake_parse_arguments(arg "" "" "STAGES" ${ARGN})
  if(name STREQUAL "rilievo")
    set(target rilievo)
  else()
    set(target rilievo_${name})
  endif()
  set(sources)
  foreach(stage ${arg_STAGES})
    file(GLOB found CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/rilievo/${stage}/*.cpp)
    list(FILTER found EXCLUDE REGEX "_(test|fuzz)\\.cpp$")
    list(APPEND sources ${found})
  endforeach()
  add_library(${target} STATIC ${sources})
  add_library(rilievo::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:rilievo_flags>)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:${RILIEVO_CORE_HEADERS}>)
  if(name STREQUAL "rilievo")
    target_link_libraries(${target} PUBLIC rilievo_core PkgConfig::epoxy PRIVATE fmt::fmt)
  else()
    target_link_libraries(${target} PUBLIC glm::glm PRIVATE ${RILIEVO_CORE_LINKS})
  endif()
  rilievo_install(${target} ${name} STAGES ${arg_STAGES})
endfunction()

# test_STAGE for every stage that has tests; each TEST becomes a test of CTest.
function(rilievo_stage_tests)
  include(GoogleTest)
  set(gl_stages gl capture draw cache compare)
  foreach(stage core scene io measure sample represent validity warp ${gl_stages})
    if(stage IN_LIST gl_stages AND NOT RILIEVO_WITH_GL)
      continue()
    endif()
    file(GLOB tests CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/rilievo/${stage}/*_test.cpp)
    if(NOT tests)
      continue()
    endif()
    add_executable(test_${stage} ${tests})
    target_link_libraries(test_${stage} PRIVATE rilievo_flags GTest::gtest_main ${RILIEVO_CORE_LINKS}
                                                ${RILIEVO_CORE_HEADERS})
    if(stage IN_LIST gl_stages)
      target_link_libraries(test_${stage} PRIVATE rilievo::rilievo PkgConfig::epoxy)
    else()
      target_link_libraries(test_${stage} PRIVATE rilievo::core)
    endif()
    gtest_discover_tests(test_${stage} TEST_PREFIX "${stage}: " DISCOVERY_TIMEOUT 60
                         PROPERTIES TIMEOUT 900)
  endforeach()
endfunction()
