# What is installed, and the Debian package of it (tools/package). What a file says is said where it lies: packaging/ has what
# only Debian wants.
include(GNUInstallDirs)
set(COMPUEYE_PAGES "" CACHE PATH "Manual and completion, written by a compueye of this machine; empty: by the one that is built")

install(TARGETS compueye RUNTIME)
install(DIRECTORY boards/ DESTINATION ${CMAKE_INSTALL_DATADIR}/compueye/boards
        PATTERN toolchains EXCLUDE PATTERN microcontrollers EXCLUDE PATTERN systemd EXCLUDE PATTERN .cache EXCLUDE PATTERN *.rules EXCLUDE)
install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/compueye/scenes)
install(FILES boards/60-compueye.rules DESTINATION lib/udev/rules.d)
install(FILES packaging/sysusers.conf DESTINATION lib/sysusers.d RENAME compueye.conf)
file(GLOB units CONFIGURE_DEPENDS boards/systemd/*.service)
install(FILES ${units} DESTINATION lib/systemd/system)

set(pages ${COMPUEYE_PAGES})
if(NOT pages AND CMAKE_CROSSCOMPILING)
  message(STATUS "Without the manual and the completion: name those of a build for this machine with COMPUEYE_PAGES")
elseif(NOT pages)
  set(pages ${PROJECT_BINARY_DIR}/pages)
  set(writer ${PROJECT_SOURCE_DIR}/packaging/write_pages.cmake)
  add_custom_command(OUTPUT ${pages}/compueye DEPENDS compueye ${writer} VERBATIM
                     COMMAND ${CMAKE_COMMAND} -D PROGRAM=$<TARGET_FILE:compueye> -D FOLDER=${pages} -P ${writer})
  add_custom_target(pages DEPENDS ${pages}/compueye)
endif()
if(pages)
  install(DIRECTORY ${pages}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
  install(FILES ${pages}/compueye DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
endif()

set(changelog ${PROJECT_BINARY_DIR}/changelog.Debian.gz)
add_custom_command(OUTPUT ${changelog} DEPENDS packaging/changelog VERBATIM
                   COMMAND gzip --best --no-name --stdout ${PROJECT_SOURCE_DIR}/packaging/changelog > ${changelog})
add_custom_target(changelog DEPENDS ${changelog})
install(FILES ${changelog} packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME compueye)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "COMPU-EYE maintainers <maintainers@compueye.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "runtime of a computational compound eye")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "A compound eye is an array of photodiodes on a dome, each of which
sees much wider than the angle to its neighbour. This runtime reads
the eye (USB, HID, SPI or simulated), corrects its overlapping samples
and solves for the picture, frame by frame, in memory and time that
are fixed before the first frame.
.
It contains the command line, boards, scenes and the rules by which
the members of group compueye may open an eye.")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "passwd, systemd | systemd-standalone-sysusers | systemd-sysusers")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "gnuplot-nox")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/packaging/postinst ${PROJECT_SOURCE_DIR}/packaging/prerm
                                       ${PROJECT_SOURCE_DIR}/packaging/postrm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_INSTALL_CMAKE_PROJECTS "${PROJECT_BINARY_DIR};compueye;ALL;/")
if(CMAKE_CROSSCOMPILING)
  # dpkg-shlibdeps knows the packages of this machine's libraries; tools/package asks it of another's.
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE ${COMPUEYE_DEBIAN_PROCESSOR})
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS OFF)
  set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/packaging/libraries.cmake)
endif()
include(CPack)
