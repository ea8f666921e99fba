# make deb: one Debian package of program, library and headers; the dependencies are read from the binaries.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pellicle)
set(PELLICLE_MAINTAINER "The Pellicle developers <pellicle@users.noreply.github.com>" CACHE STRING "maintainer of the Debian package")
set(CPACK_PACKAGE_CONTACT "${PELLICLE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulation of soft tissue and thin shells on triangle meshes")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Pellicle simulates soft tissue and thin shells that are given as triangle
surface meshes: pressed, pulled, released, inflated, shrunk, caving in and
colliding with themselves, refined where they are touched. This package
contains the program pellicle, the C library and its headers.")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "ffmpeg, paraview")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
# what Debian's policy asks for
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian.cmake)
include(CPack)
