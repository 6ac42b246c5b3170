# What `cmake --install` and the Debian packages hold. Component `runtime`: the executable with its
# assets, man page and completions. Component `development`: libraries and headers.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

# Man page and completions are printed by the executable from the tree of its commands.
set(manual ${PROJECT_BINARY_DIR}/manual)
file(MAKE_DIRECTORY ${manual})
set(completions)
foreach(shell bash zsh fish)
  add_custom_command(OUTPUT ${manual}/completion.${shell}
    COMMAND planecast completion ${shell} > ${manual}/completion.${shell} DEPENDS planecast)
  list(APPEND completions ${manual}/completion.${shell})
endforeach()
add_custom_command(OUTPUT ${manual}/planecast.1.gz
  COMMAND planecast --help-man > ${manual}/planecast.1
  COMMAND gzip -9nf ${manual}/planecast.1 DEPENDS planecast)
add_custom_target(manual ALL DEPENDS ${manual}/planecast.1.gz ${completions})

install(TARGETS planecast COMPONENT runtime)
install(PROGRAMS scripts/batch DESTINATION ${CMAKE_INSTALL_BINDIR} RENAME planecast-batch
        COMPONENT runtime)
install(DIRECTORY assets/ DESTINATION ${CMAKE_INSTALL_DATADIR}/planecast/assets COMPONENT runtime
        PATTERN CMakeLists.txt EXCLUDE PATTERN node_modules EXCLUDE)
install(FILES ${manual}/planecast.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT runtime)
install(FILES ${manual}/completion.bash COMPONENT runtime RENAME planecast
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES ${manual}/completion.zsh COMPONENT runtime RENAME _planecast
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(FILES ${manual}/completion.fish COMPONENT runtime RENAME planecast.fish
        DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright COMPONENT runtime)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/planecast)
foreach(library slam render engine flags)
  set_target_properties(planecast_${library} PROPERTIES EXPORT_NAME ${library})
  install(TARGETS planecast_${library} EXPORT planecast-targets COMPONENT development)
endforeach()
install(DIRECTORY slam render engine COMPONENT development
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/planecast FILES_MATCHING PATTERN *.h)
install(EXPORT planecast-targets NAMESPACE planecast:: DESTINATION ${package_dir}
        COMPONENT development)
configure_package_config_file(scripts/cmake/planecast-config.cmake.in
  ${PROJECT_BINARY_DIR}/planecast-config.cmake INSTALL_DESTINATION ${package_dir}
  PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/planecast-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/planecast-config.cmake scripts/cmake/dependencies.cmake
              ${PROJECT_BINARY_DIR}/planecast-config-version.cmake
        DESTINATION ${package_dir} COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME planecast)
set(CPACK_PACKAGE_CONTACT "The Planecast developers <planecast@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Puts glTF objects on the planes of a recorded image sequence")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME planecast)
# Opened at run time, so that no tool sees it.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS libosmesa6)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS libegl1)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "python3, parallel, slurm-client")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libplanecast-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "planecast (= ${PROJECT_VERSION}), libopencv-dev, libopencv-contrib-dev, libeigen3-dev, \
libceres-dev, libflann-dev, libimgui-dev, liblz4-dev, libglm-dev, libtinygltf-dev, libdraco-dev, \
libmeshoptimizer-dev, libwebp-dev, libstb-dev, libspdlog-dev, libfmt-dev, nlohmann-json3-dev, \
libyaml-cpp-dev, libavcodec-dev, libavformat-dev, libavutil-dev, libswscale-dev, pkg-config")
include(CPack)
