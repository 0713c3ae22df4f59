find_package(calibrato REQUIRED COMPONENTS kitchen)
