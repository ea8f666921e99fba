# `make wasm`: the library with scenes and live simulation as the JavaScript package build/wasm/pellicle
file(GLOB WASM_SOURCES CONFIGURE_DEPENDS src/service/wasm/*.c src/service/live/*.c)
list(FILTER WASM_SOURCES EXCLUDE REGEX "live/(server|page)[.]c$")
add_executable(pellicle_wasm ${WASM_SOURCES})
set_target_properties(pellicle_wasm PROPERTIES OUTPUT_NAME core SUFFIX .mjs RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/pellicle)
target_include_directories(pellicle_wasm PRIVATE ${PELLICLE_ROOMS})
target_link_libraries(pellicle_wasm PRIVATE pellicle_scene pellicle_flags)
# one file system in memory for meshes; the caller brings the bytes of core.wasm, so that no loader of emscripten is needed
target_link_options(pellicle_wasm PRIVATE -O3 --no-entry -sMODULARIZE -sEXPORT_ES6 -sUSE_ES6_IMPORT_META=0 -sENVIRONMENT=web,worker
                    -sALLOW_MEMORY_GROWTH -sABORTING_MALLOC=0 -sFORCE_FILESYSTEM -sTEXTDECODER=2
                    -sEXPORTED_FUNCTIONS=_malloc,_free -sEXPORTED_RUNTIME_METHODS=FS,UTF8ToString,stringToUTF8,lengthBytesUTF8)
# Debian's emscripten looks for acorn where NODE_PATH says
set_target_properties(pellicle_wasm PROPERTIES RULE_LAUNCH_LINK "${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs")

# the rest of the package: JavaScript, types, and the licences of what is inside
file(GLOB PACKAGE_FILES CONFIGURE_DEPENDS web/pellicle/*)
add_custom_command(OUTPUT ${PROJECT_BINARY_DIR}/pellicle/package.json
                   COMMAND ${CMAKE_COMMAND} -E copy ${PACKAGE_FILES} ${PROJECT_BINARY_DIR}/pellicle
                   COMMAND ${CMAKE_COMMAND} -E copy ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_BINARY_DIR}/pellicle/LICENSE
                   COMMAND ${CMAKE_COMMAND} -E copy ${SOURCES}/libfyaml/LICENSE ${PROJECT_BINARY_DIR}/pellicle/LICENSE.libfyaml
                   COMMAND ${CMAKE_COMMAND} -E copy ${SOURCES}/zlib/LICENSE ${PROJECT_BINARY_DIR}/pellicle/LICENSE.zlib
                   DEPENDS ${PACKAGE_FILES} LICENSE VERBATIM)
add_custom_target(pellicle_package ALL DEPENDS ${PROJECT_BINARY_DIR}/pellicle/package.json)
