# Run by the installation: manual pages from the command's help, completion where each shell looks for it, and the unit of the
# daemon, which names the folder that the program is installed in.
# Variables: segue (the command, where it is of another architecture after the emulator that runs it), source (the source tree).
set(prefix $ENV{DESTDIR}${CMAKE_INSTALL_PREFIX})
set(pages ${prefix}/share/man/man1)
execute_process(COMMAND ${source}/tools/man_pages ${pages} ${segue} COMMAND_ERROR_IS_FATAL ANY)
file(GLOB made ${pages}/segue*.1)
list(LENGTH made count)
message(STATUS "Installing: ${count} manual pages in ${pages}")

# zsh looks in /usr for what packages bring, and below other prefixes in site-functions.
set(zsh zsh/site-functions)
if(CMAKE_INSTALL_PREFIX STREQUAL /usr)
  set(zsh zsh/vendor-completions)
endif()
foreach(shell bash zsh fish)
  execute_process(COMMAND ${segue} completion ${shell} OUTPUT_VARIABLE ${shell}_script COMMAND_ERROR_IS_FATAL ANY)
endforeach()
# zsh reads the file when it is to complete for the first time, and expects that done.
string(APPEND zsh_script "_segue \"$@\"\n")
file(WRITE ${prefix}/share/bash-completion/completions/segue "${bash_script}")
file(WRITE ${prefix}/share/${zsh}/_segue "${zsh_script}")
file(WRITE ${prefix}/share/fish/vendor_completions.d/segue.fish "${fish_script}")
message(STATUS "Installing: completion for bash, zsh and fish in ${prefix}/share")
