# Neither errno nor trapped exceptions are read here; without them loops with roots vectorise.
target_compile_options(swage_sim PRIVATE -fno-math-errno -fno-trapping-math)
# Batches of lanes are inlined and never cross a call, so their calling convention does not matter.
target_compile_options(swage_sim PRIVATE -Wno-psabi)
