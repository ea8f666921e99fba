# make deb: Debian packages pellicle (program, scenes, pages), libpellicle-dev (libraries, headers) and python3-pellicle; the dependencies are
# read from the binaries.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pellicle)
set(PELLICLE_MAINTAINER "The Pellicle developers <pellicle@users.noreply.github.com>" CACHE STRING "maintainer of the Debian packages")
set(CPACK_PACKAGE_CONTACT "${PELLICLE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulation of soft tissue and thin shells on triangle meshes")
set(ABOUT "Pellicle simulates soft tissue and thin shells on triangle surface meshes:
pressed, pulled, released, inflated, cut, torn, in contact with themselves
and refined where they are touched.")
set(CPACK_COMPONENTS_ALL program dev python)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME pellicle)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "simulation of soft tissue and thin shells on triangle meshes
${ABOUT} This package contains the program pellicle.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "ffmpeg, paraview, python3-pellicle")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libpellicle-dev)
set(CPACK_DEBIAN_DEV_DESCRIPTION "simulation of soft tissue and thin shells: C library
${ABOUT} This package contains the libraries, their headers, and files for
CMake and pkg-config.")
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
# what programs that use the archives link
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "zlib1g-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "libfyaml-dev, libassimp-dev, libepoxy-dev, libfreetype-dev, libpng-dev")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-pellicle)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "simulation of soft tissue and thin shells: Python package
${ABOUT} This package contains the Python package pellicle.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3-numpy")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "pellicle, python3-scipy")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
# what Debian's policy asks for
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian.cmake)
include(CPack)
