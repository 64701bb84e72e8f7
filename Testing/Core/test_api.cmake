# The header is compiled as C++ too.
target_sources(mlim_test_api PRIVATE "${CMAKE_CURRENT_LIST_DIR}/test_api_cxx.cxx")
