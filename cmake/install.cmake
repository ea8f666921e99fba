install(TARGETS pellicle EXPORT pellicleTargets)
install(DIRECTORY include/pellicle DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
