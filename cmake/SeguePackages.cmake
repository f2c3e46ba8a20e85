# The Debian packages of `make package`. Which package a file belongs to is said by the COMPONENT of its install rule: runtime,
# dev, components, ros2, studio, examples. Included last: what is installed here is made by the installed command.
set(packaging ${CMAKE_SOURCE_DIR}/packaging)

# Manual pages, and completion where each shell looks for it.
if(TARGET segue)
  install(CODE "set(segue ${CMAKE_CROSSCOMPILING_EMULATOR} $<TARGET_FILE:segue>)\nset(source ${CMAKE_SOURCE_DIR})\nset(version ${PROJECT_VERSION})" COMPONENT runtime)
  install(SCRIPT ${packaging}/install_pages.cmake COMPONENT runtime)
  install(FILES ${packaging}/segue-deployment.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
  install(FILES ${packaging}/segue-export.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT dev)
endif()
# In a package only.
install(DIRECTORY examples/ DESTINATION share/doc/segue-examples/examples COMPONENT examples EXCLUDE_FROM_ALL
        USE_SOURCE_PERMISSIONS)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME segue)
set(CPACK_PACKAGE_VENDOR Segue)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_DEBIAN_PACKAGE_SECTION misc)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${packaging}/finish_tree.cmake)
set(CPACK_COMPONENTS_ALL runtime dev components ros2 examples)
if(CMAKE_CROSSCOMPILING)
  # Which packages the libraries are from is looked up in the other Debian (tools/arm64_root), not in this computer's.
  set(shlibdeps "set(SHLIBDEPS_EXECUTABLE env DEB_HOST_ARCH=${CPACK_DEBIAN_PACKAGE_ARCHITECTURE} dpkg-shlibdeps -S${CMAKE_SYSROOT})")
endif()
# Variables of finish_tree.cmake; CPack passes on what begins with CPACK_ only, unless it stands in a file of the project's.
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/PackageProject.cmake @ONLY CONTENT [[
set(SEGUE_PACKAGING "@packaging@")
set(SEGUE_PAGE_PACKAGES "@CMAKE_BINARY_DIR@/ui/work")
set(PROJECT_VERSION "@PROJECT_VERSION@")
unset(CPACK_PACKAGE_DESCRIPTION_SUMMARY)  # each package has its own
include(@packaging@/maintainer.cmake)
@shlibdeps@
]])
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_BINARY_DIR}/PackageProject.cmake)

# segue_package(COMPONENT NAME summary "description" [FIELD value]...): the Debian package of a component, with fields such as
# PACKAGE_DEPENDS (CPACK_DEBIAN_<COMPONENT>_<FIELD>).
function(segue_package COMPONENT NAME SUMMARY DESCRIPTION)
  string(TOUPPER ${COMPONENT} upper)
  set(about "Segue runs robots that must do many different things. Each thing is a
controller, a network of components. The runtime switches the robot from any
controller to any other, and undoes a switch that fails.")
  set(fields PACKAGE_NAME ${NAME} DESCRIPTION "${SUMMARY}\n${about}\n.\n${DESCRIPTION}" ${ARGN})
  while(fields)
    list(POP_FRONT fields field value)
    set(CPACK_DEBIAN_${upper}_${field} "${value}" PARENT_SCOPE)
  endwhile()
endfunction()

set(same "(= ${PROJECT_VERSION})")
segue_package(runtime segue "runtime for robots that must do many different things"
  "This package has the command, the libraries, and the daemon of a computer with
parts of robots (segue-host.service)."
  PACKAGE_DEPENDS adduser
  PACKAGE_RECOMMENDS "python3, segue-components ${same}, segue-studio ${same}")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA ${packaging}/postinst ${packaging}/prerm ${packaging}/postrm ${packaging}/triggers)
segue_package(dev segue-dev "components and robots in C++ for Segue"
  "This package has headers and a CMake package, for those who write components,
or programs that contain a robot."
  PACKAGE_SECTION libdevel
  PACKAGE_DEPENDS "segue ${same}, libexpected-dev"
  PACKAGE_SUGGESTS "cmake, g++, libeigen3-dev, segue-components ${same}, segue-examples ${same}")
segue_package(components segue-components "components of robots for Segue"
  "This package has components to begin with: navigation, manipulation, planning,
a simulated rover, connections between computers, and those of the robot that
segue init makes."
  PACKAGE_DEPENDS "segue ${same}")
segue_package(ros2 segue-ros2 "topics and services of ROS 2 as tasks of Segue"
  "This package has components that publish and subscribe to topics of ROS 2, and
call its services, and the program by which the command looks at its nodes. An
installation of ROS 2 is not needed."
  PACKAGE_DEPENDS "segue ${same}")
segue_package(examples segue-examples "examples of robots, components and missions for Segue"
  "This package has robots and programs to read and to try, each explained."
  PACKAGE_ARCHITECTURE all
  PACKAGE_DEPENDS "segue ${same}"
  PACKAGE_RECOMMENDS "segue-components ${same}, segue-dev ${same}")
if(TARGET studio_page)
  list(APPEND CPACK_COMPONENTS_ALL studio)
  segue_package(studio segue-studio "browser page to watch and operate robots of Segue"
    "This package has the page that segue studio serves: the network of a running
robot, its switches, its missions and its samples."
    PACKAGE_ARCHITECTURE all
    PACKAGE_DEPENDS "segue ${same}")
endif()
include(CPack)
