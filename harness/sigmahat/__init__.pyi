"""The public names, for lazy_loader and type checkers; see __init__.py."""

from .checks.check import check as check
from .checks.findings import Checked as Checked
from .checks.findings import Finding as Finding
from .export.plant_fmu import PlantVariable as PlantVariable
from .export.plant_fmu import write_plant_fmu as write_plant_fmu
from .fmi.installed import fmu as fmu
from .fmi.instance import FmuError as FmuError
from .fmi.master import EstimatorFmu as EstimatorFmu
from .fmi.master import Plant as Plant
from .fmi.master import Recording as Recording
from .fmi.master import simulate as simulate
from .fmi.series import Series as Series
from .identification.identify import identify as identify
from .identification.quantities import Identified as Identified
from .identification.quantities import Quantity as Quantity
from .joint.curve import Branch as Branch
from .joint.curve import Curve as Curve
from .joint.sheet import Polynomial as Polynomial
from .library.estimator import Estimator as Estimator
from .logs.configuration import Configuration as Configuration
from .logs.configuration import Port as Port
from .logs.configuration import Time as Time
from .logs.configuration import read_configuration as read_configuration
from .logs.estimate import Estimate as Estimate
from .logs.estimate import estimate as estimate
from .logs.log import Log as Log
from .logs.log import LogError as LogError
from .logs.readers.formats import open_log as open_log
from .paper.scenarios import scenario as scenario
from .plants.equations import PlantEquations as PlantEquations
from .plants.equations import encoder as encoder
from .runs.engine import run as run
from .runs.metrics import Indices as Indices
from .runs.metrics import indices as indices
from .runs.metrics import mean_error as mean_error
from .runs.metrics import mse as mse
from .runs.metrics import msrep as msrep
from .runs.scenario import Comparison as Comparison
from .runs.scenario import Scenario as Scenario
from .runs.scenario import Sine as Sine
from .runs.scenario import Sines as Sines
from .validation.validate import Agreement as Agreement
from .validation.validate import TorqueError as TorqueError
from .validation.validate import Validation as Validation
from .validation.validate import validate as validate

__all__: list[str]
__version__: str
