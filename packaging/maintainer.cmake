# Who the packages name as their maintainer (SEGUE_MAINTAINER): the variable of the environment with that name, such as
# "Ada Lovelace <ada@example.org>", or who git says that makes them, or, where git does not know, the authors, without an address.
set(shape "^[^<>,]+ <[^<>@ ]+@[^<>@ ]+[.][^<>@ ]+>$")
set(SEGUE_MAINTAINER "$ENV{SEGUE_MAINTAINER}")
if(SEGUE_MAINTAINER STREQUAL "")
  foreach(key name email)
    execute_process(COMMAND git config user.${key} WORKING_DIRECTORY ${SEGUE_PACKAGING} OUTPUT_VARIABLE ${key}
                    OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE status ERROR_QUIET)
  endforeach()
  set(SEGUE_MAINTAINER "${name} <${email}>")
  if(NOT SEGUE_MAINTAINER MATCHES "${shape}")
    set(SEGUE_MAINTAINER "The authors of Segue <maintainers@segue.invalid>")
    message(NOTICE "The packages name no maintainer that can be written to: set git's user.name and user.email, or SEGUE_MAINTAINER.")
  endif()
elseif(NOT SEGUE_MAINTAINER MATCHES "${shape}")
  message(FATAL_ERROR "SEGUE_MAINTAINER is '${SEGUE_MAINTAINER}'; write NAME <ADDRESS>, such as Ada Lovelace <ada@example.org>")
endif()
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${SEGUE_MAINTAINER}")
