// Nothing is tested here: see tactus_no_tests in tests/CMakeLists.txt.
