# The parts of OpenCV that are asked for as COMPONENTS, each the target OpenCV::<part>. Debian keeps OpenCV's own configuration in
# libopencv-dev, which brings VTK and 200 packages more.
find_path(OpenCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
set(OpenCV_REQUIRED OpenCV_INCLUDE_DIR)
foreach(part IN LISTS OpenCV_FIND_COMPONENTS)
  find_library(OpenCV_${part}_LIBRARY opencv_${part})
  list(APPEND OpenCV_REQUIRED OpenCV_${part}_LIBRARY)
  if(OpenCV_${part}_LIBRARY AND NOT TARGET OpenCV::${part})
    add_library(OpenCV::${part} UNKNOWN IMPORTED GLOBAL)
    set_target_properties(OpenCV::${part} PROPERTIES IMPORTED_LOCATION ${OpenCV_${part}_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${OpenCV_INCLUDE_DIR})
  endif()
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCV REQUIRED_VARS ${OpenCV_REQUIRED})
