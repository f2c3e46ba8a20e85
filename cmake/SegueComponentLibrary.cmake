# segue_add_component_library(NAME SOURCES ... [LINK targets...])
# A library of components (SEGUE_COMPONENT) that robots name under `libraries`: lib<NAME>.so in <build>/lib/segue with
# <NAME>.components.yaml beside it, which tells tools what the components look like without loading them. Both are
# installed to lib/segue. Without a build type (CMAKE_BUILD_TYPE) they are optimised, with debug information. Works inside
# Segue and, after find_package(segue), anywhere else.
include_guard()
include(GNUInstallDirs)

function(segue_add_component_library NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  if(NOT ARG_SOURCES)
    message(FATAL_ERROR "segue_add_component_library(${NAME}): name the sources under SOURCES")
  endif()
  set(folder ${CMAKE_BINARY_DIR}/lib/segue)
  set(models ${folder}/${NAME}.components.yaml)

  add_library(${NAME} SHARED ${ARG_SOURCES})
  target_link_libraries(${NAME} PRIVATE segue::task ${ARG_LINK})
  target_compile_features(${NAME} PRIVATE cxx_std_20)
  if(NOT CMAKE_CXX_FLAGS MATCHES "-O")  # without a build type CMake optimises nothing
    target_compile_options(${NAME} PRIVATE "$<$<STREQUAL:$<CONFIG>,>:-O2;-g>")
  endif()
  set_target_properties(${NAME} PROPERTIES PREFIX lib SUFFIX .so LIBRARY_OUTPUT_DIRECTORY ${folder}
                        INSTALL_RPATH "$ORIGIN:$ORIGIN/..")
  # The linker would drop libraries that only registration uses.
  target_link_options(${NAME} PRIVATE -Wl,--no-as-needed)

  add_dependencies(${NAME} segue::export_tool)
  add_custom_command(TARGET ${NAME} POST_BUILD
                     COMMAND segue::export_tool $<TARGET_FILE:${NAME}> ${models}
                     BYPRODUCTS ${models} COMMENT "Describing the components of ${NAME}" VERBATIM)
  install(TARGETS ${NAME} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/segue)
  install(FILES ${models} DESTINATION ${CMAKE_INSTALL_LIBDIR}/segue)
endfunction()
