# `pellicle live`: HTTP and WebSocket, on top of the scene library
file(GLOB LIVE_SOURCES CONFIGURE_DEPENDS src/service/live/*.c)
add_library(pellicle_live STATIC ${LIVE_SOURCES})
add_library(pellicle::live ALIAS pellicle_live)
target_include_directories(pellicle_live PRIVATE ${PELLICLE_ROOMS})
target_link_libraries(pellicle_live PUBLIC pellicle PRIVATE $<BUILD_INTERFACE:pellicle_flags> pellicle_scene
                      Threads::Threads)
