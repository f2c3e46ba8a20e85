# Run by CPack between installation and packaging, for what is right in a package of Debian's only: libraries of /usr/lib
# are found without search paths in programs, what /usr/share/doc has to hold, and overrides of lintian.
file(GLOB trees ${CPACK_TEMPORARY_DIRECTORY}/*)
foreach(tree IN LISTS trees)
  cmake_path(GET tree FILENAME component)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})

  file(GLOB_RECURSE binaries ${tree}/usr/bin/* ${tree}/usr/lib/*.so*)
  foreach(binary IN LISTS binaries)
    if(NOT IS_SYMLINK ${binary})
      file(RPATH_REMOVE FILE ${binary})
    endif()
  endforeach()

  file(GLOB pages ${tree}/usr/share/man/man1/*.1)
  if(pages)
    execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
  endif()

  set(documents ${tree}/usr/share/doc/${package})
  configure_file(${SEGUE_PACKAGING}/changelog ${documents}/changelog @ONLY)
  execute_process(COMMAND gzip -9n ${documents}/changelog COMMAND_ERROR_IS_FATAL ANY)
  configure_file(${SEGUE_PACKAGING}/copyright ${documents}/copyright COPYONLY)
  if(component STREQUAL studio)
    execute_process(COMMAND ${SEGUE_PACKAGING}/page_licences ${SEGUE_PAGE_PACKAGES}
                    OUTPUT_VARIABLE licences COMMAND_ERROR_IS_FATAL ANY)
    file(APPEND ${documents}/copyright "${licences}")
  endif()
  if(EXISTS ${SEGUE_PACKAGING}/${package}.lintian-overrides)
    configure_file(${SEGUE_PACKAGING}/${package}.lintian-overrides ${tree}/usr/share/lintian/overrides/${package} COPYONLY)
  endif()
endforeach()
