# Beside CGAL's own triangulation.
add_executable(mlim_test_delaunay_peer "${CMAKE_CURRENT_LIST_DIR}/test_delaunay_peer.cxx")
target_link_libraries(mlim_test_delaunay_peer PRIVATE mlim_core CGAL::CGAL)
target_compile_features(mlim_test_delaunay_peer PRIVATE cxx_std_17)
target_compile_options(mlim_test_delaunay_peer PRIVATE -frounding-math)
add_test(NAME test_delaunay_peer COMMAND mlim_test_delaunay_peer)
set_tests_properties(test_delaunay_peer PROPERTIES LABELS core)
