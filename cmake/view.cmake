# pictures and films: on top of the scene library
pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
find_package(Freetype REQUIRED)
find_package(PNG REQUIRED)
find_file(PELLICLE_FONT DejaVuSans.ttf PATHS /usr/share/fonts/truetype/dejavu /usr/share/fonts/dejavu
          /usr/share/fonts/dejavu-sans-fonts /usr/share/fonts/TTF NO_DEFAULT_PATH DOC "font of the labels in pictures")
if(NOT PELLICLE_FONT)
    message(WARNING "DejaVuSans.ttf was not found: 'pellicle render' will need PELLICLE_FONT in the environment")
    set(PELLICLE_FONT /usr/share/fonts/truetype/dejavu/DejaVuSans.ttf CACHE FILEPATH "" FORCE)
endif()

file(GLOB VIEW_SOURCES CONFIGURE_DEPENDS view/*.c)
add_library(pellicle_view STATIC ${VIEW_SOURCES})
add_library(pellicle::view ALIAS pellicle_view)
target_include_directories(pellicle_view PRIVATE ${PROJECT_SOURCE_DIR})
target_compile_definitions(pellicle_view PRIVATE PELLICLE_VIEW_FONT="${PELLICLE_FONT}")
target_link_libraries(pellicle_view PUBLIC pellicle PRIVATE $<BUILD_INTERFACE:pellicle_flags> pellicle_scene
                      PkgConfig::EPOXY Freetype::Freetype PNG::PNG)
