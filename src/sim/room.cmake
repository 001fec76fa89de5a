# Neither errno nor trapped exceptions are read here; without them loops with roots vectorise.
target_compile_options(swage_sim PRIVATE -fno-math-errno -fno-trapping-math)
