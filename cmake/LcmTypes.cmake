set(ROUNDABOUT_HARDEN_STRINGS ${CMAKE_CURRENT_LIST_DIR}/HardenStrings.cmake)

# roundabout_lcm_types(TARGET FILES…): a header-only library of the C++ types that lcm-gen makes.
function(roundabout_lcm_types target)
  set(out ${CMAKE_CURRENT_BINARY_DIR}/include)
  set(headers)
  foreach(file ${ARGN})
    get_filename_component(type ${file} NAME_WE)
    set(header ${out}/roundabout_msgs/${type}.hpp)
    add_custom_command(OUTPUT ${header}
      COMMAND ${LCM_GEN} --cpp --cpp-hpath ${out} ${CMAKE_CURRENT_SOURCE_DIR}/${file}
      COMMAND ${CMAKE_COMMAND} -DHEADER=${header} -P ${ROUNDABOUT_HARDEN_STRINGS}
      DEPENDS ${file} ${ROUNDABOUT_HARDEN_STRINGS} VERBATIM COMMENT "lcm-gen ${file}")
    list(APPEND headers ${header})
  endforeach()
  add_custom_target(${target}_headers DEPENDS ${headers})
  add_library(${target} INTERFACE)
  add_dependencies(${target} ${target}_headers)
  target_include_directories(${target} SYSTEM INTERFACE ${out})
  target_link_libraries(${target} INTERFACE roundabout::lcm)
endfunction()
