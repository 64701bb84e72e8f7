# Hosts have threads.
find_package(Threads REQUIRED)
target_link_libraries(mlim_test_team PRIVATE Threads::Threads)
